#pragma once
// Noise coefficients as tables.

#include <string>

#include "libchar/core/table/table.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/lot/device_record.hpp"

namespace libchar {

/// A row for each term that has something to say; `process`: those of a Gauss–Markov process, its
/// standard deviation and correlation time. A clock's terms have a clock's words.
Table coefficients_table(const Coefficients& terms, const std::string& unit,
                         const std::vector<Coefficient>& process = {}, bool clock = false);
Table coefficients_table(const NoiseFit& fit, const std::string& unit);

/// A clock's noise in its own words; no rows for any other channel.
Table power_laws_table(const NoiseFit& fit, const std::string& unit);

/// The coefficients that tell most, each in the unit of the field: N, B, K and how well they fit.
inline constexpr const char* kHeadlines = "N, white noise|B, bias instability|K, random walk|fit";
/// `spoilt`: marked as not to be relied on, whatever its status.
Cell headline_cell(const Coefficient& coefficient, Term term, const std::string& unit, bool spoilt = false);
std::vector<Cell> headline_cells(const Channel& channel, const NoiseFit& fit);
std::vector<Cell> headline_cells(const RecordedChannel& channel);
inline constexpr const char* kHeadlineNote =
    "In brackets: 95 % intervals. ≤: not detected, upper 95 % limit. ?: do not rely on it; the recording's own report "
    "gives the reason.";

}  // namespace libchar

#pragma once
// Noise coefficients of a record with honest uncertainties. Theory and figures: docs/theory/fit.md.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/fit/fit_options.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/fit/record/power_bins.hpp"
#include "libchar/fit/record/record_sums.hpp"
#include "libchar/fit/signs/event.hpp"
#include "libchar/fit/signs/temperature.hpp"

namespace libchar {

struct FitWorkspace;  // allan_fit.hpp

/// Widens intervals, limits and covariance by a factor >= 1 and calls what has a value a misfit:
/// the coefficients scatter more than the likelihood says.
void widen_as_misfit(double wider, NoiseFit& fit);

/// The main fit: maximum Whittle likelihood on the bins, decisions, intervals, bounds. `allan` is what the second
/// opinion is made of (may be null). Throws Error(numeric) when there are fewer bins than terms.
NoiseFit fit_power_bins(const std::vector<PowerBin>& bins, double rate_hz, std::uint64_t samples,
                        const AllanCurve* allan, const FitOptions& options = {}, FitWorkspace* workspace = nullptr);

/// The same on the powers of a record, spectral lines clipped when remedies are on. `samples` without the missing
/// ones; `spent`: of the degree of freedom of coefficient k = 1.. at [k-1], by means that were taken out.
NoiseFit fit_powers(std::span<const PooledPower> powers, double rate_hz, std::uint64_t samples, const AllanCurve* allan,
                    const FitOptions& options = {}, FitWorkspace* workspace = nullptr,
                    std::span<const double> spent = {});

/// What the caller of `fit_record` knows of its record; none of it is needed.
struct RecordKnowledge {
  /// what it does to the record is taken out before the noise is fitted
  const TemperatureRecord* temperature = nullptr;
  const EventSeries* series = nullptr;   ///< of the record at its rate, computed already
  std::optional<std::uint64_t> missing;  ///< samples, counted already
};

/// Alarms, remedies, bins, fit, second opinion, of samples in memory. A record of more than a leaf
/// (2^20 samples) is fitted by its sums, unless a temperature is given.
NoiseFit fit_record(std::span<const double> record, double rate_hz, const AllanCurve* allan,
                    const FitOptions& options = {}, FitWorkspace* workspace = nullptr,
                    const RecordKnowledge& known = {});

/// The same of a record of more than a leaf, whoever has the samples. `allan`: of `sums`.
NoiseFit fit_sums(RecordSums sums, double rate_hz, const AllanCurve* allan, const FitOptions& options = {},
                  FitWorkspace* workspace = nullptr);

}  // namespace libchar

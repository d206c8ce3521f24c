#pragma once
// Curves that another program (or our own allan, psd and characterize) wrote as a table with named columns.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/fit/curve/curve_fit.hpp"

namespace libchar {

struct NamedCurve {
  std::string name, unit;
  DigitisedCurve curve;
  /// Of our own tables, for those who draw them; as long as the curve, or empty where there is no such column. NaN: an
  /// empty cell.
  std::vector<double> low68, high68, low95, high95, model;
  std::string kind;                    ///< in the column `curve`: "oadev", "psd_one_sided"; empty: there is none
  std::string value_unit;              ///< in the column `unit`, unchanged
  std::vector<Finding> findings = {};  ///< in the column `findings` of our own tables
};

struct CurveTable {
  std::vector<NamedCurve> curves;
  std::uint64_t at_zero = 0;  ///< rows at 0 Hz, which are left out: they say nothing about noise
  std::uint64_t bytes = 0;
  std::string sha256;
};

/// Curves of a table with a header that names them:
/// - Averaging time (tau, tau_s, x) or frequency (frequency_hz, frequency, f, x).
/// - Values (deviation, adev, oadev, sigma, value; avar, variance; psd).
/// - If present: channel, unit, curve.
/// - If present, how well a value is known, in this order: edf or dof; low68 and high68; rel_err or relative_error;
///   error, sd or uncertainty.
///
/// A relative error is one standard deviation of the value: a fraction, or percent when its header says %. An error, sd
/// or uncertainty is in the unit of the value. One curve for each name in the channel column, in the order of their
/// first rows. Or the spectra that psd prints: frequency_hz and a column NAME[UNIT] for each channel. Nothing when the
/// header does not name an abscissa and a value: such a file is a plain table of numbers.
/// Throws Error(input) with FILE:LINE:COL for a row that does not fit.
std::optional<CurveTable> read_curve_table(const std::string& path, bool is_allan);

namespace detail {
/// What averaging times ("ms", "min") or frequencies ("kHz") are multiplied by to be in s or Hz; 1 for another unit.
double abscissa_factor(const std::string& unit, bool is_allan);
}  // namespace detail

/// "allan", "psd" or "allan or psd" where the header of a file can only be that of such a table ("x" and "value" may be
/// a log's); empty otherwise, and for what is not a regular file. Throws nothing about the file.
std::string curve_in_header(const std::string& path);

}  // namespace libchar

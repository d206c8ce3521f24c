#pragma once
// Ways to get noise coefficients from a record: ours, and those that the field uses.

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "libchar/benchmark/bench_document.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/numeric/interval.hpp"

namespace libchar {

struct CoefficientEstimate {
  std::optional<double> value;  ///< nothing: not detected, or not estimated by this method
  std::optional<Interval> ci95;
};
using NoiseEstimate = std::array<CoefficientEstimate, kTerms>;

struct Estimator {
  std::string_view name;
  std::string_view what;  ///< a sentence, for the legend
  /// `terms`: those that are in the record, for methods that have to be told.
  NoiseEstimate (*estimate)(std::span<const double> record, double rate_hz, const TermSet& terms);
  bool is_ours = true;  ///< else a recipe of another tool
  bool told = false;    ///< it is told the terms; else it decides, or always gives all of its own
};

/// All of them, the program's default first.
const std::vector<Estimator>& estimators();

// Estimators that other tools use, written anew from their descriptions and not from their code.

/// IEEE Std 952-1997, annex C: read off the curve, by the local slope.
NoiseEstimate read_off(std::span<const double> record, double rate_hz, const TermSet& terms);
/// Unweighted least squares on ln variance of the terms white, flicker and walk.
NoiseEstimate log_log(std::span<const double> record, double rate_hz, const TermSet& terms);
/// As nmayorov's script: sum of (model / variance - 1)^2 over coefficients >= 0, at 100 logarithmic strides up to N/10.
NoiseEstimate relative_least_squares(std::span<const double> record, double rate_hz, const TermSet& terms);
/// imu_utils: overlapping Allan variances at 100 logarithmic strides up to the largest power of two below N/2, least
/// squares on their log10 with equal weights, five squared coefficients (2 ln 2/pi B^2 for flicker). Its objective is
/// minimised from four starts around the third, so that it is compared and not an optimizer.
NoiseEstimate imu_utils(std::span<const double> record, double rate_hz, const TermSet& terms);
/// allan_variance_ros: averages of 0.1 s, 0.2 s … 999.9 s side by side without overlap. N: mean of ln sigma sqrt(tau)
/// for tau < 10 s; K: sqrt 3 times the geometric mean of sigma/sqrt(tau) over all periods; B: the lowest sigma.
NoiseEstimate allan_variance_ros(std::span<const double> record, double rate_hz, const TermSet& terms);

// Simulated records of a signal.

/// theta of what a simulation of the model uses.
Mixture truth_of(const SensorModel& model);

/// One sensor, its noise alone.
std::vector<double> record_of(const BenchSignal& signal, std::uint64_t seed);

/// The mean of so many independent ones.
std::vector<double> mean_of_records(const BenchSignal& signal, std::uint64_t sensors, std::uint64_t seed);

// Cost against error: which methods nobody beats in both.

struct CostAndError {
  double cost = 0, error = 0;  ///< NaN in either: does not take part
};

/// How far each is from the front: its error over the least error of any that costs no more, minus
/// one. 0: it is on the front. NaN: it does not take part.
std::vector<double> front_gaps(const std::vector<CostAndError>& points);

}  // namespace libchar

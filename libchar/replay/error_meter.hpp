#pragma once
// How wrong an estimate is, streaming: sums per cell of time, from which every score follows.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/core/numeric/interval.hpp"

namespace libchar {

/// Sums over one stretch of consecutive samples.
struct ErrorCell {
  double n = 0;        ///< samples with an estimate
  double sum = 0;      ///< of the error
  double squares = 0;  ///< of its square
  double maximum = 0;  ///< of its magnitude
  double missing = 0;  ///< samples without an estimate
};

/// Memory does not grow with the record: when 4096 cells are full, neighbours are merged and cells
/// become twice as long. Two meters that saw equally many samples have equal cells.
class ErrorMeter {
 public:
  /// Errors in order; NaN = no estimate (or no truth) at this instant.
  void push(std::span<const double> error);
  /// The cells, the last one possibly shorter than `cell_samples`.
  std::vector<ErrorCell> cells() const;
  std::uint64_t cell_samples() const { return cell_samples_; }
  /// Of a meter that has seen so many samples.
  static std::uint64_t cell_samples_of(std::uint64_t samples);
  /// The same, but only the cells in which the other (which saw equally many samples) has an estimate too.
  ErrorMeter where_known(const ErrorMeter& other) const;

 private:
  void put(double error);
  std::vector<ErrorCell> cells_;
  std::uint64_t cell_samples_ = 1, in_last_ = 0;
};

struct ErrorScore {
  double rmse = 0;  ///< NaN without a sample
  Interval rmse_ci95;
  double bias = 0;
  Interval bias_ci95;
  double deviation = 0;  ///< standard deviation: without a constant offset of the reference
  double maximum = 0;
  double availability = 0;  ///< share of instants with an estimate
  std::uint64_t samples = 0;
  double converged_s = 0;  ///< from here on the RMS of a window is within a tenth of its final level; NaN: never
  /// false: the error walks or drifts over the record, so that another stretch may have any other;
  /// then there are no intervals
  bool stationary = true;
};

struct ScoreOptions {
  bool intervals = true;
  /// first samples of stretches that are known to differ (a sensor fails, or comes back), rising:
  /// intervals are about records with the same stretches
  std::vector<std::int64_t> sections = {};
};

/// All scores of one estimate. Intervals from the scatter of batch means, extended to the whole
/// record (detail/mean_uncertainty.hpp).
ErrorScore score(const ErrorMeter& meter, double rate_hz, const ScoreOptions& options = {});

/// Errors that are judged together: one, or one for each sensor.
using Meters = std::vector<const ErrorMeter*>;

/// Geometric mean of the root mean squares, and its 95 % interval. In this mean no error counts for more because it is
/// larger: it is the Gaussian predictive likelihood of all, each with a variance of its own.
struct GeometricRms {
  double rms = 0;
  Interval ci95;
};
GeometricRms geometric_rms(const Meters& meters, const ScoreOptions& options = {});

/// Interval of the ratio of the geometric means (RMSE_a / RMSE_b of one meter each), from what both saw at the same
/// time (equally long meters). `level`: share of such intervals that miss. Contains 1: the difference is not resolved.
Interval rms_ratio_interval(const Meters& a, const Meters& b, const ScoreOptions& options = {}, double level = 0.05);

/// Sign test: how probable it is by chance that a's errors are the larger ones in so many of
/// sixteen equal stretches of the record. It says something where a few huge errors hide every
/// difference from the ratio of root mean squares. 1: nothing to compare.
double larger_throughout(const Meters& a, const Meters& b);

}  // namespace libchar

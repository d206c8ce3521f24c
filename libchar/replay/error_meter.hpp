#pragma once
// How wrong an estimate is, streaming: sums per cell of time, from which every score follows.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/core/interval.hpp"

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
  double deviation =
      0;  ///< standard deviation: what is left beside a constant offset of the reference
  double maximum = 0;
  double availability = 0;  ///< share of instants with an estimate
  std::uint64_t samples = 0;
  double converged_s =
      0;  ///< from here on the RMS of a window is within a tenth of its final level; NaN: never
};

struct ScoreOptions {
  std::size_t blocks = 40;  ///< length of a bootstrap block: record / blocks
  std::size_t replicates = 1000;
  std::uint64_t seed = 1;
};

/// All scores of one estimate. Intervals by moving-block bootstrap (Künsch 1989) on the cells.
ErrorScore score(const ErrorMeter& meter, double rate_hz, const ScoreOptions& options = {});

/// 95 % interval of RMSE_a / RMSE_b, the same resampled stretches for both (equally long meters).
/// Contains 1: the difference is not resolved.
Interval rmse_ratio_ci95(const ErrorMeter& a,
                         const ErrorMeter& b,
                         const ScoreOptions& options = {});

}  // namespace libchar

#pragma once
// The score of a step at every place of a series at once.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/fit/detail/events/regression.hpp"

namespace libchar {

struct StepScan {
  static constexpr std::uint64_t kEvery = 8;
  std::vector<double>
      score;  ///< [t]: of a step between points t-1 and t; 0 where none is looked for
  /// standard deviations of neighbouring scores' differences at every kEvery-th place, for rough_threshold
  std::vector<double> distance;
  std::uint64_t best = 0;  ///< where |score| is largest
  double best_score() const { return score[best]; }
};

/// Scores beside what a regression already holds; no step is looked for in the first and last `margin` points.
StepScan scan_steps(const Regression& beside,
                    std::span<const double> weight,
                    std::uint64_t points,
                    std::uint64_t margin);

/// Where the step that is best within `margin` of `at` stands with 95 %: the places beside it whose score squared is at most 7.35
/// below its own.
Interval step_place(const StepScan& scan, double at, std::uint64_t margin);

}  // namespace libchar

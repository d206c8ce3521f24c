#pragma once
// The score of a step at every place of a series at once.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "libchar/fit/detail/events/regression.hpp"
#include "libchar/fit/signs/events.hpp"

namespace libchar {

// Are the steps of a record the jumps of a two-level process?

/// From six steps on, of one size within their standard deviations and a quarter, up as well as down. `further`: places
/// beside them where the scores ask for more.
std::optional<Telegraph> telegraph_of(std::span<const Event> events, int further, double duration_s);

// The score of a warm-up at every time constant of a grid, and of a ramp.

struct WarmUpScan {
  std::vector<double> tau;       ///< in points, rising by a quarter
  std::vector<double> score;     ///< of each
  std::vector<double> distance;  ///< for smooth_threshold
  std::size_t best = 0;
};

/// Time constants from eight points (or a thousandth of the series) to half the series.
WarmUpScan scan_warm_ups(const Regression& beside, const SeriesGrid& grid, std::span<const double> weight);

/// The best time constant between the neighbours of the scan's best, in points.
double refined_tau(const WarmUpScan& scan, const Regression& beside, const SeriesGrid& grid,
                   std::span<const double> weight);

/// The best cycle of .6 to 2.7 periods (faster ones are lines, and cycles.hpp takes them out), and the root of what it
/// explains; one that is surely below `least` is placed by the step of the scan.
struct CycleScan {
  double place = 0, phase = 0;  ///< as an EventShape has them
  double score = 0;
};
CycleScan scan_cycles(const Regression& beside, const SeriesGrid& grid, std::span<const double> weight,
                      double least = 0);

Score ramp_score(const Regression& beside, const SeriesGrid& grid, std::span<const double> weight);

// How large the largest of many correlated normal scores is by chance.

/// P(Z > u) of a standard normal, and its density.
double normal_tail(double u);
double normal_density(double u);

/// The u that the largest |score| of a chain of standard normal scores passes with probability `alpha`. `distance[i]`
/// is the standard deviation of score i+1 less score i.
///   rough:  the scores move like a random walk from one to the next (places of a step); every distance stands for
///           `each`
///   smooth: they lie on a smooth curve (time constants of a drift)
double rough_threshold(std::span<const double> distance, double alpha, double each = 1);
double smooth_threshold(std::span<const double> distance, double alpha);

struct StepScan {
  static constexpr std::size_t kEvery = 8;
  std::vector<double> score;  ///< [t]: of a step between points t-1 and t; 0 where none is looked for
  /// standard deviations of neighbouring scores' differences at every kEvery-th place, for rough_threshold
  std::vector<double> distance;
  std::size_t best = 0;  ///< where |score| is largest
  double best_score() const { return score[best]; }
};

/// Scores beside what a regression already holds; no step is looked for in the first and last `margin` points.
StepScan scan_steps(const Regression& beside, std::span<const double> weight, std::size_t points, std::size_t margin);

/// Where the step that is best within `margin` of `at` stands with 95 %: the places beside it whose score squared is at
/// most 7.35 below its own.
Interval step_place(const StepScan& scan, double at, std::size_t margin);

}  // namespace libchar

#pragma once
// The score of a warm-up at every time constant of a grid, and of a ramp.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/fit/detail/events/regression.hpp"

namespace libchar {

struct WarmUpScan {
  std::vector<double> tau;       ///< in points, rising by a quarter
  std::vector<double> score;     ///< of each
  std::vector<double> distance;  ///< for smooth_threshold
  std::size_t best = 0;
};

/// Time constants from eight points (or a thousandth of the series) to half the series.
WarmUpScan scan_warm_ups(const Regression& beside,
                         const SeriesGrid& grid,
                         std::span<const double> weight);

/// The best time constant between the neighbours of the scan's best, in points.
double refined_tau(const WarmUpScan& scan,
                   const Regression& beside,
                   const SeriesGrid& grid,
                   std::span<const double> weight);

Score ramp_score(const Regression& beside, const SeriesGrid& grid, std::span<const double> weight);

}  // namespace libchar

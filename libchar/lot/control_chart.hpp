#pragma once
// Individuals in the order in which they were made: does the process stay where it is?

#include <cstddef>
#include <span>
#include <vector>

#include "libchar/core/numeric/interval.hpp"
#include "libchar/lot/zone_rules.hpp"

namespace libchar {

/// Some values that follow each other: one, where there are few of them.
struct ChartPoint {
  std::size_t first = 0, count = 1;
  double mean = 0, low = 0, high = 0;
};

struct ChartValue {
  std::size_t index = 0;
  double value = 0;
};

struct ControlChart {
  double centre = 0;
  double sigma = 0;                ///< from value to value: mean moving range over 1.128
  Interval limits;                 ///< centre ± 3 sigma
  std::vector<ChartPoint> points;  ///< at most kChartPoints
  std::vector<ChartValue> beyond;  ///< outside of the limits, in order
  ZoneFindings zones;              ///< nothing where sigma is zero
};

inline constexpr std::size_t kChartPoints = 300;
/// Fewer values have no chart.
inline constexpr std::size_t kLeastForChart = 8;

/// At least two values.
ControlChart control_chart(std::span<const double> values);

}  // namespace libchar

// Individuals chart (Montgomery, Introduction to Statistical Quality Control, 6.4): sigma = mean |x_i - x_{i-1}| / d2, d2 = 2/sqrt(pi) =
// 1.128, limits at the mean ± 3 sigma. How often chance leaves them or stays on a side: zone_rules.hpp.
#include "libchar/lot/control_chart.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace libchar {
namespace {

std::vector<ChartPoint> chart_points(std::span<const double> values) {
  const std::size_t n = values.size(), points = std::min(n, kChartPoints);
  std::vector<ChartPoint> out;
  for (std::size_t k = 0; k < points; ++k) {
    const std::size_t first = k * n / points, end = (k + 1) * n / points;
    const auto part = values.subspan(first, end - first);
    const auto [low, high] = std::minmax_element(part.begin(), part.end());
    double sum = 0;
    for (const double x : part) sum += x;
    out.push_back({first, part.size(), sum / static_cast<double>(part.size()), *low, *high});
  }
  return out;
}

}  // namespace

ControlChart control_chart(std::span<const double> values) {
  ControlChart out;
  const double n = static_cast<double>(values.size());
  double sum = 0, ranges = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += values[i] - values[0];
    if (i > 0) ranges += std::abs(values[i] - values[i - 1]);
  }
  out.centre = values[0] + sum / n;
  out.sigma = ranges / (n - 1) / (2 / std::sqrt(std::numbers::pi));
  out.limits = {out.centre - 3 * out.sigma, out.centre + 3 * out.sigma};
  out.points = chart_points(values);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (values[i] < out.limits.low || values[i] > out.limits.high)
      out.beyond.push_back({i, values[i]});
  if (out.sigma > 0) out.zones = zone_findings(values, out.centre, out.sigma);
  return out;
}

}  // namespace libchar

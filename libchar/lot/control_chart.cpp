// Individuals chart (Montgomery, Introduction to Statistical Quality Control, 6.4): sigma = mean |x_i - x_{i-1}| / d2, d2 = 2/sqrt(pi) =
// 1.128, limits at the mean ± 3 sigma. A normal process leaves them with 0.27 % of its values. A stretch of eight or more on one side
// (Western Electric) begins at a value with probability 2^-8: it and seven more are on one side, the one before on the other.
#include "libchar/lot/control_chart.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace libchar {
namespace {

constexpr std::size_t kRun = 8;
constexpr double kBeyondThreeSigma = 0.0026997960632601866;

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

std::size_t count_runs(std::span<const double> values, double centre) {
  std::size_t runs = 0, length = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool same = i > 0 && (values[i] > centre) == (values[i - 1] > centre);
    length = same ? length + 1 : 1;
    runs += length == kRun;
  }
  return runs;
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
  out.beyond_by_chance = n * kBeyondThreeSigma;
  out.runs = count_runs(values, out.centre);
  // The first value begins a stretch whatever stood before it: 2 times as probable.
  out.runs_by_chance = n < kRun ? 0 : (n - kRun + 2) * std::exp2(-static_cast<double>(kRun));
  if (out.sigma > 0) out.zones = zone_findings(values, out.centre, out.sigma);
  return out;
}

}  // namespace libchar

// The line of slope -1/2 that the curve touches from above gives Q = sigma sqrt(tau), its value at
// 1 s; the one of slope +1/2 gives K = sigma sqrt(3/tau), its value at 3 s; the minimum is at most
// 0.664 B + what Q and K add [RV 1.4.1]. A line is drawn only where the local slope is within 1/4
// of its own: reading K off a point that is not on the +1/2 asymptote is wrong by factors of 29 to
// 140.

#include "libchar/allan/read_off.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace libchar {
namespace {

constexpr double kSlopeTolerance = 0.25;

std::vector<AllanPoint> usable_points(const AllanCurve& curve) {
  std::vector<AllanPoint> usable;
  for (const AllanPoint& p : curve.points)
    if (p.reliable && p.deviation > 0) usable.push_back(p);
  return usable;
}

/// Index of the point where the local log-log slope is nearest to `slope`, if it is near enough;
/// among equals the lowest value of deviation / tau^slope, which is where the line touches.
std::optional<std::size_t> touching(const std::vector<AllanPoint>& points, double slope) {
  std::optional<std::size_t> best;
  double lowest = HUGE_VAL;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const AllanPoint &a = points[i - 1], &b = points[i + 1];
    const double local = std::log(b.deviation / a.deviation) / std::log(b.tau_s / a.tau_s);
    const double level = points[i].deviation * std::pow(points[i].tau_s, -slope);
    if (std::fabs(local - slope) > kSlopeTolerance || level >= lowest) continue;
    lowest = level;
    best = i;
  }
  return best;
}

}  // namespace

ReadOff read_off(const AllanCurve& curve) {
  ReadOff marks;
  const std::vector<AllanPoint> points = usable_points(curve);
  if (points.empty()) return marks;
  const auto least =
      std::min_element(points.begin(), points.end(), [](const AllanPoint& a, const AllanPoint& b) {
        return a.deviation < b.deviation;
      });
  marks.minimum = least->deviation;
  marks.minimum_tau_s = least->tau_s;
  marks.bias_instability_upper =
      marks.minimum / std::sqrt(2 * std::numbers::ln2 / std::numbers::pi);
  if (const auto i = touching(points, -0.5)) {
    marks.white_tau_s = points[*i].tau_s;
    marks.white_noise = points[*i].deviation * std::sqrt(points[*i].tau_s);
  }
  if (const auto i = touching(points, 0.5)) {
    marks.walk_tau_s = points[*i].tau_s;
    marks.random_walk = points[*i].deviation * std::sqrt(3 / points[*i].tau_s);
  }
  return marks;
}

}  // namespace libchar

// The look-elsewhere effect. With d_i the standard deviation of the difference of neighbouring scores, Q the normal tail, phi its
// density:
//   rough    P(max > u) <= Q(u) + sum_i u phi(u) (d_i^2 / 2) nu(u d_i),
//            nu(x) = (2/x) (Phi(x/2) - 1/2) / ((x/2) Phi(x/2) + phi(x/2))
//            (D. Siegmund, Sequential Analysis, 1985; D. Siegmund and B. Yakir, The Statistics of Gene Mapping, 2007): scores
//            whose correlation falls linearly with distance, looked at in steps; far apart (x large) it is Bonferroni's sum.
//   smooth   P(max > u) <= Q(u) + sum_i min(Q(u), a_i phi(u) / sqrt(2 pi)), a_i = 2 asin(d_i / 2): the length of the curve that
//            the scores' directions draw on the sphere (H. Hotelling, American Journal of Mathematics 61, 1939), and Bonferroni.
// Twice that for both signs. No constant of these is fitted: the threshold follows from the number of scores and from the model.
#include "libchar/fit/detail/events/look_elsewhere.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace libchar {
namespace {

double overshoot(double x) {
  if (x < 1e-6) return 1;
  const double half = x / 2, below = 1 - normal_tail(half);
  return 2 / x * (below - 0.5) / (half * below + normal_density(half));
}

/// u with exceedance(u) = alpha of a decreasing function.
template <typename Exceedance>
double bisect(const Exceedance& exceedance, double alpha) {
  double low = 0, high = 40;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (exceedance(middle) > alpha ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Distances in sixteen classes an octave: a class is at most two per cent from its members.
struct DistanceClasses {
  static constexpr int kOctaves = 48, kClasses = 16;
  std::array<double, kOctaves * kClasses + 1> count{};

  explicit DistanceClasses(std::span<const double> distance) {
    for (const double d : distance) {
      if (!(d > 0)) continue;
      const double octaves = std::clamp(std::log2(d) + kOctaves - 1, 0.0, double{kOctaves});
      count[static_cast<std::size_t>(octaves * kClasses + 0.5)] += 1;
    }
  }
  static double distance_of(std::size_t i) {
    return std::exp2(static_cast<double>(i) / kClasses - (kOctaves - 1));
  }
};

}  // namespace

double normal_tail(double u) {
  return 0.5 * std::erfc(u / std::numbers::sqrt2);
}

double normal_density(double u) {
  return std::exp(-0.5 * u * u) / std::sqrt(2 * std::numbers::pi);
}

double rough_threshold(std::span<const double> distance, double alpha, double each) {
  const DistanceClasses classes(distance);
  const auto exceedance = [&](double u) {
    double sum = 0;
    for (std::size_t i = 0; i < classes.count.size(); ++i) {
      if (classes.count[i] == 0) continue;
      const double d = DistanceClasses::distance_of(i);
      sum += each * classes.count[i] * d * d / 2 * overshoot(u * d);
    }
    return 2 * (normal_tail(u) + u * normal_density(u) * sum);
  };
  return bisect(exceedance, alpha);
}

double smooth_threshold(std::span<const double> distance, double alpha) {
  const auto exceedance = [&](double u) {
    double sum = normal_tail(u);
    const double arc = normal_density(u) / std::sqrt(2 * std::numbers::pi);
    for (const double d : distance)
      sum += std::min(normal_tail(u), 2 * std::asin(std::min(1.0, d / 2)) * arc);
    return 2 * sum;
  };
  return bisect(exceedance, alpha);
}

}  // namespace libchar

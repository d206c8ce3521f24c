// Means of m samples of flicker: the sampled spectrum 1/(2 sin(phi/2)) times the response of the mean, folded,
//   (1/m) sum_j [sin(a/2) / (m sin(phi_j/2))]^2 / (2 |sin(phi_j/2)|),  phi_j = (a + 2 pi j)/m,  a = pi k/n,
// beside it the exact lowest coefficients of flicker (dct_means.cpp); means of a walk are the walk less a white part,
// K^2 m dt (1/(4 sin^2(a/2)) - (1 - 1/m^2)/6).
#include "libchar/fit/detail/events/series_powers.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libchar/fit/detail/record/dct_means.hpp"

namespace libchar {
namespace {

using std::numbers::pi;

constexpr std::size_t kExact = 64;         ///< coefficients at which a function is called one by one
constexpr double kGrid = 1.0442737824274;  ///< sixteenth of an octave

/// Flicker of means over flicker of samples at the means' rate.
double flicker_of_means(double a, std::uint64_t m) {
  if (m == 1) return 1;
  const double width = static_cast<double>(m), sine = std::sin(a / 2);
  const auto reach = static_cast<int>(std::min<std::uint64_t>(m / 2, 16));
  double sum = 0;
  for (int j = -reach; j <= reach; ++j) {
    if (2 * j == static_cast<int>(m)) continue;  // the same as -m/2
    const double fold = std::abs(std::sin((a + 2 * pi * j) / (2 * width)));
    sum += 1 / (fold * fold * fold);
  }
  return sum * sine * sine * sine / (width * width * width);
}

}  // namespace

std::array<double, kTerms> mean_unit_powers(double k, std::uint64_t n, std::uint64_t m, double dt_s) {
  const double step = dt_s * static_cast<double>(m), width = static_cast<double>(m);
  std::array<double, kTerms> unit = dct_mean(k, n, step);
  unit[static_cast<std::size_t>(Term::flicker)] *= flicker_of_means(pi * k / static_cast<double>(n), m);
  unit[static_cast<std::size_t>(Term::walk)] -= step * (1 - 1 / (width * width)) / 6;
  return unit;
}

std::vector<std::vector<double>> at_every_k(std::size_t n, std::size_t count,
                                            const std::function<void(double, std::span<double>)>& power) {
  std::vector<std::vector<double>> all(count, std::vector<double>(n - 1));
  const std::size_t exact = std::min(kExact, n - 1);
  std::vector<double> at_low(count), at_high(count);
  for (std::size_t k = 1; k <= exact; ++k) {
    power(static_cast<double>(k), at_low);
    for (std::size_t i = 0; i < count; ++i) all[i][k - 1] = at_low[i];
  }
  double low = static_cast<double>(exact) + 0.5;
  power(low, at_low);
  for (std::size_t k = exact + 1; k < n;) {
    const double high = low * kGrid;
    power(std::min(high, static_cast<double>(n)), at_high);
    const std::size_t end = std::min(n, static_cast<std::size_t>(high) + 1);
    for (std::size_t i = 0; i < count; ++i) {
      const double slope = (at_high[i] - at_low[i]) / (high - low);
      for (std::size_t j = k; j < end; ++j) all[i][j - 1] = at_low[i] + slope * (static_cast<double>(j) - low);
    }
    k = std::max(k, end);
    low = high;
    at_low.swap(at_high);
  }
  return all;
}

std::vector<LevelStretch> level_stretches(std::size_t coefficients) {
  constexpr std::size_t kFirst = 256, kFew = 64;
  std::vector<LevelStretch> stretches;
  for (std::size_t from = kFirst; from < coefficients;) {
    std::size_t to = std::min(coefficients, from + std::max(kFew, from / 6));
    if (coefficients - to < kFew) to = coefficients;
    stretches.push_back({from, to});
    from = to;
  }
  return stretches;
}

double deviance_of(std::span<const double> coefficients, std::span<const double> power) {
  // A free level l of n coefficients has -2 ln L = n ln l + sum ln E + n at l = mean of c^2 / E.
  double sum = 0;
  const std::vector<LevelStretch> stretches = level_stretches(power.size());
  const std::size_t first = stretches.empty() ? power.size() : stretches[0].from;
  for (std::size_t k = 0; k < first; ++k) sum += coefficients[k] * coefficients[k] / power[k] + std::log(power[k]);
  for (const auto& [from, to] : stretches) {
    double level = 0, product = 1;
    for (std::size_t k = from; k < to; ++k) {
      level += coefficients[k] * coefficients[k] / power[k];
      product *= power[k] / power[from];  // within a stretch powers differ little
      if (product > 1e-200 && product < 1e200) continue;
      sum += std::log(product);
      product = 1;
    }
    const double count = static_cast<double>(to - from);
    sum += std::log(product) + count * (std::log(power[from]) + std::log(level / count) + 1);
  }
  return sum;
}

void raise_to_measured(std::span<const double> coefficients, std::vector<double>& power) {
  for (const auto& [from, to] : level_stretches(power.size())) {
    double sum = 0;
    for (std::size_t k = from; k < to; ++k) sum += coefficients[k] * coefficients[k] / power[k];
    const double count = static_cast<double>(to - from), ratio = sum / count;
    if (ratio > 1 + 4 * std::sqrt(2 / count))
      for (std::size_t k = from; k < to; ++k) power[k] *= ratio;
  }
}

}  // namespace libchar

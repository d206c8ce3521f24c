#include "libchar/benchmark/figure.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libchar/core/numeric/chi_square.hpp"
#include "libchar/core/numeric/distributions.hpp"

namespace libchar {
namespace {

constexpr double kOutside = 0.025;  // on either side of an interval

constexpr double kOutsideOfRuns = 0.005, kLeastOfTimes = 0.015;

/// The largest k for which fewer than k of n values lie below the median with at most this probability; 0: none.
std::size_t median_rank(std::size_t n, double outside) {
  const auto trials = static_cast<double>(n);
  std::size_t k = 0;
  while (k < n / 2 && binomial_cdf(static_cast<double>(k), trials, 0.5) <= outside) ++k;
  return k;
}

Figure median_within(std::vector<double> values, double outside) {
  Figure out;
  out.count = values.size();
  if (values.empty()) return out;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  out.value =
      n % 2 == 1 ? values[n / 2] : values[n / 2 - 1] + (values[n / 2] - values[n / 2 - 1]) / 2;
  if (const std::size_t k = median_rank(n, outside); k > 0)
    out.ci95 = {values[k - 1], values[n - k]};
  return out;
}

}  // namespace

Figure median_figure(std::vector<double> values) {
  return median_within(std::move(values), kOutside);
}

Figure time_figure(std::vector<double> values) {
  Figure out = median_within(std::move(values), kOutsideOfRuns);
  out.ci95.low = std::min(out.ci95.low, (1 - kLeastOfTimes) * out.value);
  out.ci95.high = std::max(out.ci95.high, (1 + kLeastOfTimes) * out.value);
  return out;
}

Figure mean_figure(const std::vector<double>& values) {
  Figure out;
  out.count = values.size();
  if (values.empty()) return out;
  const auto n = static_cast<double>(values.size());
  double sum = 0, squares = 0;
  for (const double v : values) sum += v - values[0];
  out.value = values[0] + sum / n;
  for (const double v : values) squares += (v - out.value) * (v - out.value);
  if (values.size() < 2) return out;
  const double half = student_quantile(1 - kOutside, n - 1) * std::sqrt(squares / (n - 1) / n);
  out.ci95 = {out.value - half, out.value + half};
  return out;
}

Figure rms_figure(const std::vector<double>& values) {
  Figure out;
  out.count = values.size();
  if (values.empty()) return out;
  double squares = 0;
  for (const double v : values) squares += v * v;
  out.value = std::sqrt(squares / static_cast<double>(values.size()));
  out.ci95 = chi_square_interval(out.value, static_cast<double>(values.size()), 0.95);
  return out;
}

Figure share_figure(std::size_t hits, std::size_t count) {
  Figure out;
  out.count = count;
  if (count == 0) return out;
  const auto n = static_cast<double>(count);
  const double p = static_cast<double>(hits) / n, z2 = kNormal95 * kNormal95;
  const double centre = (p + z2 / (2 * n)) / (1 + z2 / n);
  const double half = kNormal95 / (1 + z2 / n) * std::sqrt(p * (1 - p) / n + z2 / (4 * n * n));
  out.value = p;
  out.ci95 = {std::max(0.0, centre - half), std::min(1.0, centre + half)};
  return out;
}

bool unresolved(const Figure& a, const Figure& b) {
  return !(a.ci95.high < b.ci95.low || b.ci95.high < a.ci95.low);
}

}  // namespace libchar

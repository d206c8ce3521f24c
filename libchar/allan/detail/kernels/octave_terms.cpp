#include "libchar/allan/detail/kernels/octave_terms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/allan/detail/kernels/missing_samples.hpp"

namespace libchar {
namespace {

double sum_of(const double* values, std::size_t width) {
  if (width == 1) return values[0];
  if (width == 2) return values[0] + values[1];
  return (values[0] + values[2]) + (values[1] + values[3]);
}

}  // namespace

void add_one_by_one(
    const double* z, std::size_t n, std::size_t width, double scale, PresentTerms& tally) {
  double lane[8] = {};
  std::uint64_t terms = 0;
  for (std::size_t i = 0; i + 2 * width <= n; ++i) {
    double d = (z[i + width] - z[i]) * scale;
    if (width == 2) d = (z[i + 2] - z[i]) * scale + (z[i + 3] - z[i + 1]) * scale;
    if (width == 4)
      d = ((z[i + 4] - z[i]) * scale + (z[i + 6] - z[i + 2]) * scale) +
          ((z[i + 5] - z[i + 1]) * scale + (z[i + 7] - z[i + 3]) * scale);
    if (std::isnan(d)) continue;
    lane[i % 8] += d * d;
    ++terms;
  }
  const double sum =
      ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
  tally.squares += static_cast<long double>(sum) / static_cast<long double>(scale) /
                   static_cast<long double>(scale);
  tally.terms += terms;
  tally.starts += terms;
}

void add_present(
    const Holed& z, std::size_t n, std::size_t width, double scale, PresentTerms& tally) {
  const double m = z.size * static_cast<double>(width);
  double squares = 0, shortfall = 0, imbalance = 0;
  for (std::size_t i = 0; i + 2 * width <= n; ++i) {
    const double a = m - sum_of(z.absent + i, width), b = m - sum_of(z.absent + i + width, width);
    imbalance += (b - a) / m * ((b - a) / m);
    ++tally.starts;
    if (!has_mean(a, m) || !has_mean(b, m)) continue;
    const double d = (sum_of(z.sum + i + width, width) * scale) * (m / b) -
                     (sum_of(z.sum + i, width) * scale) * (m / a);
    squares += d * d;
    shortfall += 1 / a + 1 / b - 2 / m;
    ++tally.terms;
  }
  const auto wide = static_cast<long double>(scale);
  tally.squares += static_cast<long double>(squares) / wide / wide;
  tally.shortfall += static_cast<long double>(shortfall);
  tally.imbalance += static_cast<long double>(imbalance);
}

void split_present(const double* x, std::size_t n, double origin, double* sum, double* absent) {
  for (std::size_t i = 0; i < n; ++i) {
    absent[i] = std::isnan(x[i]) ? 1 : 0;
    sum[i] = std::isnan(x[i]) ? 0 : x[i] - origin;
  }
}

bool any_absent(const double* absent, std::size_t n) {
  return std::any_of(absent, absent + n, [](double count) { return count > 0; });
}

double block_scale(const double* z, std::size_t n) {
  double first = std::numeric_limits<double>::quiet_NaN(), largest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (std::isnan(z[i])) continue;
    if (std::isnan(first)) first = z[i];
    largest = std::max(largest, std::fabs(z[i] - first));
  }
  if (largest == 0 || !std::isfinite(largest)) return 1;
  return std::ldexp(1.0, std::clamp(-std::ilogb(largest), -1000, 1000));
}

}  // namespace libchar

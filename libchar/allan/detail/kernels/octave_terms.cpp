#include "libchar/allan/detail/kernels/octave_terms.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "libchar/allan/detail/kernels/eight_lanes.hpp"
#include "libchar/allan/detail/kernels/present_points.hpp"
#include "libchar/core/numeric/lanes.hpp"

namespace libchar {
namespace {

double sum_of(const double* values, std::size_t width) {
  if (width == 1) return values[0];
  if (width == 2) return values[0] + values[1];
  return (values[0] + values[2]) + (values[1] + values[3]);
}

}  // namespace

void add_one_by_one(const double* z, std::size_t n, std::size_t width, double scale, PresentTerms& tally) {
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
  const double sum = ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
  tally.squares += static_cast<long double>(sum) / static_cast<long double>(scale) / static_cast<long double>(scale);
  tally.terms += terms;
  tally.starts += terms;
}

void add_present(const Holed& z, std::size_t n, std::size_t width, double scale, PresentTerms& tally) {
  const double m = z.size * static_cast<double>(width);
  double squares = 0, shortfall = 0, imbalance = 0;
  for (std::size_t i = 0; i + 2 * width <= n; ++i) {
    const double a = m - sum_of(z.absent + i, width), b = m - sum_of(z.absent + i + width, width);
    imbalance += (b - a) / m * ((b - a) / m);
    ++tally.starts;
    if (!has_mean(a, m) || !has_mean(b, m)) continue;
    const double d =
        (sum_of(z.sum + i + width, width) * scale) * (m / b) - (sum_of(z.sum + i, width) * scale) * (m / a);
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

namespace {

[[gnu::always_inline]] inline double of_one(const double* z) { return z[1] - z[0]; }
[[gnu::always_inline]] inline double of_two(const double* z) { return (z[2] - z[0]) + (z[3] - z[1]); }
[[gnu::always_inline]] inline double of_four(const double* z) {
  return ((z[4] - z[0]) + (z[6] - z[2])) + ((z[5] - z[1]) + (z[7] - z[3]));
}

// The same for four starts at once.
#define FOUR_OF_ONE(z) (LIBCHAR_FOUR((z) + 1) - LIBCHAR_FOUR(z))
#define FOUR_OF_TWO(z) ((LIBCHAR_FOUR((z) + 2) - LIBCHAR_FOUR(z)) + (LIBCHAR_FOUR((z) + 3) - LIBCHAR_FOUR((z) + 1)))
#define FOUR_OF_FOUR(z)                                                                            \
  (((LIBCHAR_FOUR((z) + 4) - LIBCHAR_FOUR(z)) + (LIBCHAR_FOUR((z) + 6) - LIBCHAR_FOUR((z) + 2))) + \
   ((LIBCHAR_FOUR((z) + 5) - LIBCHAR_FOUR((z) + 1)) + (LIBCHAR_FOUR((z) + 7) - LIBCHAR_FOUR((z) + 3))))

}  // namespace

LIBCHAR_LANES double squares_of_four_lanes(const double* z, std::size_t n) {
  if (n < 8) return 0;
  double lane[kLanes] = {};
  const std::size_t terms = n - 7, whole = terms / kLanes * kLanes;
  Four low = {}, high = {};
  for (std::size_t i = 0; i < whole; i += kLanes) {
    const Four d = FOUR_OF_FOUR(z + i), e = FOUR_OF_FOUR(z + i + 4);
    low += d * d;
    high += e * e;
  }
  std::memcpy(lane, &low, sizeof low);
  std::memcpy(lane + 4, &high, sizeof high);
  for (std::size_t i = whole; i < terms; ++i) {
    const double d = of_four(z + i);
    lane[i % kLanes] += d * d;
  }
  return sum_of_lanes(lane);
}

double squares_of_four(const double* z, std::size_t n) { return InLanes<squares_of_four_lanes>()(z, n); }

LIBCHAR_LANES void squares_of_one_two_four_lanes(const double* z, std::size_t n, double out[3]) {
  double one[kLanes] = {}, two[kLanes] = {}, four[kLanes] = {};
  const std::size_t whole = n >= 8 ? (n - 7) / kLanes * kLanes : 0;
  Four sum[6] = {};
  for (std::size_t i = 0; i < whole; i += kLanes) {
    for (std::size_t h = 0; h < 2; ++h) {
      const double* const p = z + i + 4 * h;
      const Four a = FOUR_OF_ONE(p), b = FOUR_OF_TWO(p), c = FOUR_OF_FOUR(p);
      sum[h] += a * a;
      sum[2 + h] += b * b;
      sum[4 + h] += c * c;
    }
  }
  std::memcpy(one, &sum[0], sizeof one);
  std::memcpy(two, &sum[2], sizeof two);
  std::memcpy(four, &sum[4], sizeof four);
  for (std::size_t i = whole; i + 1 < n; ++i) {
    const double a = of_one(z + i);
    one[i % kLanes] += a * a;
    if (i + 3 < n) {
      const double b = of_two(z + i);
      two[i % kLanes] += b * b;
    }
    if (i + 7 < n) {
      const double c = of_four(z + i);
      four[i % kLanes] += c * c;
    }
  }
  out[0] = sum_of_lanes(one);
  out[1] = sum_of_lanes(two);
  out[2] = sum_of_lanes(four);
}

void squares_of_one_two_four(const double* z, std::size_t n, double out[3]) {
  return InLanes<squares_of_one_two_four_lanes>()(z, n, out);
}

LIBCHAR_LANES void sum_pairs_lanes(const double* z, std::size_t pairs, double origin, double* pair) {
  for (std::size_t i = 0; i < pairs; ++i) pair[i] = (z[2 * i] - origin) + (z[2 * i + 1] - origin);
}

void sum_pairs(const double* z, std::size_t pairs, double origin, double* pair) {
  return InLanes<sum_pairs_lanes>()(z, pairs, origin, pair);
}

LIBCHAR_LANES bool all_finite_lanes(const double* z, std::size_t n) {
  Four sum[2] = {};  // x - x is 0 for a number, NaN for NaN and infinity
  const std::size_t whole = n / kLanes * kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes)
    for (std::size_t h = 0; h < 2; ++h) {
      const Four v = LIBCHAR_FOUR(z + i + 4 * h);
      sum[h] += v - v;
    }
  double lane[kLanes];
  std::memcpy(lane, sum, sizeof lane);
  for (std::size_t i = whole; i < n; ++i) lane[i % kLanes] += z[i] - z[i];
  return sum_of_lanes(lane) == 0;
}

bool all_finite(const double* z, std::size_t n) { return InLanes<all_finite_lanes>()(z, n); }

}  // namespace libchar

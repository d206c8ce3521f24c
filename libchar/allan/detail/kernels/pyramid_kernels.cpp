#include "libchar/allan/detail/kernels/pyramid_kernels.hpp"

#include <cstring>

#include "libchar/allan/detail/kernels/eight_lanes.hpp"
#include "libchar/core/numeric/lanes.hpp"

namespace libchar {
namespace {

[[gnu::always_inline]] inline double of_one(const double* z) {
  return z[1] - z[0];
}
[[gnu::always_inline]] inline double of_two(const double* z) {
  return (z[2] - z[0]) + (z[3] - z[1]);
}
[[gnu::always_inline]] inline double of_four(const double* z) {
  return ((z[4] - z[0]) + (z[6] - z[2])) + ((z[5] - z[1]) + (z[7] - z[3]));
}

// The same for four starts at once.
#define FOUR_OF_ONE(z) (LIBCHAR_FOUR((z) + 1) - LIBCHAR_FOUR(z))
#define FOUR_OF_TWO(z) \
  ((LIBCHAR_FOUR((z) + 2) - LIBCHAR_FOUR(z)) + (LIBCHAR_FOUR((z) + 3) - LIBCHAR_FOUR((z) + 1)))
#define FOUR_OF_FOUR(z)                                                                            \
  (((LIBCHAR_FOUR((z) + 4) - LIBCHAR_FOUR(z)) + (LIBCHAR_FOUR((z) + 6) - LIBCHAR_FOUR((z) + 2))) + \
   ((LIBCHAR_FOUR((z) + 5) - LIBCHAR_FOUR((z) + 1)) +                                              \
    (LIBCHAR_FOUR((z) + 7) - LIBCHAR_FOUR((z) + 3))))

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

double squares_of_four(const double* z, std::size_t n) {
  return InLanes<squares_of_four_lanes>()(z, n);
}

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

LIBCHAR_LANES void sum_pairs_lanes(const double* z,
                                   std::size_t pairs,
                                   double origin,
                                   double* pair) {
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

bool all_finite(const double* z, std::size_t n) {
  return InLanes<all_finite_lanes>()(z, n);
}

}  // namespace libchar

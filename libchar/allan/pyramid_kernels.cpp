#include "libchar/allan/pyramid_kernels.hpp"

#define LIBCHAR_CLONES __attribute__((target_clones("avx2", "default")))

namespace libchar {
namespace {

constexpr std::size_t kLanes = 8;

double fold(const double (&lane)[kLanes]) {
  return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

[[gnu::always_inline]] inline double of_one(const double* z) {
  return z[1] - z[0];
}
[[gnu::always_inline]] inline double of_two(const double* z) {
  return (z[2] - z[0]) + (z[3] - z[1]);
}
[[gnu::always_inline]] inline double of_four(const double* z) {
  return ((z[4] - z[0]) + (z[6] - z[2])) + ((z[5] - z[1]) + (z[7] - z[3]));
}

}  // namespace

LIBCHAR_CLONES double squares_of_four(const double* z, std::size_t n) {
  if (n < 8) return 0;
  double lane[kLanes] = {};
  const std::size_t terms = n - 7, whole = terms / kLanes * kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes)
    for (std::size_t k = 0; k < kLanes; ++k) {
      const double d = of_four(z + i + k);
      lane[k] += d * d;
    }
  for (std::size_t i = whole; i < terms; ++i) {
    const double d = of_four(z + i);
    lane[i % kLanes] += d * d;
  }
  return fold(lane);
}

LIBCHAR_CLONES void squares_of_one_two_four(const double* z, std::size_t n, double out[3]) {
  double one[kLanes] = {}, two[kLanes] = {}, four[kLanes] = {};
  const std::size_t whole = n >= 8 ? (n - 7) / kLanes * kLanes : 0;
  for (std::size_t i = 0; i < whole; i += kLanes)
    for (std::size_t k = 0; k < kLanes; ++k) {
      const double* const p = z + i + k;
      const double a = of_one(p), b = of_two(p), c = of_four(p);
      one[k] += a * a;
      two[k] += b * b;
      four[k] += c * c;
    }
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
  out[0] = fold(one);
  out[1] = fold(two);
  out[2] = fold(four);
}

LIBCHAR_CLONES void sum_pairs(const double* z, std::size_t pairs, double origin, double* pair) {
  for (std::size_t i = 0; i < pairs; ++i) pair[i] = (z[2 * i] - origin) + (z[2 * i + 1] - origin);
}

LIBCHAR_CLONES bool all_finite(const double* z, std::size_t n) {
  double lane[kLanes] = {};  // x - x is 0 for a number, NaN for NaN and infinity
  const std::size_t whole = n / kLanes * kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes)
    for (std::size_t k = 0; k < kLanes; ++k) lane[k] += z[i + k] - z[i + k];
  for (std::size_t i = whole; i < n; ++i) lane[i % kLanes] += z[i] - z[i];
  return fold(lane) == 0;
}

}  // namespace libchar

#include "libchar/core/present.hpp"

#include <cmath>

#include "libchar/core/lanes.hpp"

namespace libchar {
namespace {

constexpr std::size_t kPiece = 64;  // looked at together

// x != x for a missing sample only; x - x is no number for an infinity either.
LIBCHAR_WIDE_LANES std::size_t whole_present_pieces(const double* x, std::size_t n) {
  std::size_t i = 0;
  for (; i + kPiece <= n; i += kPiece) {
    Four sum = {};
    auto missing = sum != sum;
    for (std::size_t k = 0; k < kPiece; k += 4) {
      const Four v = LIBCHAR_FOUR(x + i + k);
      missing |= v != v;
    }
    if ((missing[0] | missing[1] | missing[2] | missing[3]) != 0) break;
  }
  return i;
}

LIBCHAR_WIDE_LANES std::size_t whole_finite_pieces(const double* x, std::size_t n) {
  std::size_t i = 0;
  for (; i + kPiece <= n; i += kPiece) {
    Four sum = {};
    for (std::size_t k = 0; k < kPiece; k += 4) {
      const Four v = LIBCHAR_FOUR(x + i + k);
      sum += v - v;
    }
    if (!((sum[0] + sum[1]) + (sum[2] + sum[3]) == 0)) break;
  }
  return i;
}

LIBCHAR_WIDE_LANES std::size_t missing_in(const double* x, std::size_t n) {
  Four none = {};
  auto count = none != none;  // minus one for every missing sample of the lane
  std::size_t i = 0;
  for (; i + 4 <= n; i += 4) {
    const Four v = LIBCHAR_FOUR(x + i);
    count += v != v;
  }
  auto missing = static_cast<std::size_t>(-(count[0] + count[1] + count[2] + count[3]));
  for (; i < n; ++i) missing += x[i] != x[i];
  return missing;
}

}  // namespace

std::size_t present_run(std::span<const double> samples) {
  std::size_t n = whole_present_pieces(samples.data(), samples.size());
  while (n < samples.size() && !std::isnan(samples[n])) ++n;
  return n;
}

std::size_t finite_run(std::span<const double> samples) {
  std::size_t n = whole_finite_pieces(samples.data(), samples.size());
  while (n < samples.size() && std::isfinite(samples[n])) ++n;
  return n;
}

std::size_t count_missing(std::span<const double> samples) {
  return missing_in(samples.data(), samples.size());
}

}  // namespace libchar

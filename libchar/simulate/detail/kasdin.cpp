// N. J. Kasdin, "Discrete simulation of colored noise and stochastic processes and 1/f^alpha power
// law noise generation", Proc. IEEE 83 (1995) 802-827; [RV 1.19-1.28].

#include "libchar/simulate/detail/kasdin.hpp"

#include <algorithm>

#include "libchar/core/numeric/lanes.hpp"

namespace libchar {
namespace {

/// Sum of a[i] b[i] in eight lanes, the same with and without AVX.
LIBCHAR_LANES double dot_lanes(const double* a, const double* b, std::size_t count) {
  Four low = {}, high = {};
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    low += LIBCHAR_FOUR(a + i) * LIBCHAR_FOUR(b + i);
    high += LIBCHAR_FOUR(a + i + 4) * LIBCHAR_FOUR(b + i + 4);
  }
  double rest = 0;
  for (; i < count; ++i) rest += a[i] * b[i];
  const Four sum = low + high;
  return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + rest;
}
constexpr InLanes<dot_lanes> dot;

}  // namespace

TruncatedKasdin::TruncatedKasdin(std::size_t taps) : reversed_(taps) {
  double b = 1;
  for (std::size_t k = 1; k <= taps; ++k) {
    b = b * (static_cast<double>(k) - 1.5) / static_cast<double>(k);
    reversed_[taps - k] = -b;
  }
  past_.assign(std::max<std::size_t>(2 * taps, taps + 1024), 0.0);
}

void TruncatedKasdin::run(std::span<double> values) {
  const std::size_t taps = reversed_.size();
  for (double& value : values) {
    if (at_ + taps == past_.size()) {
      std::copy(past_.end() - static_cast<std::ptrdiff_t>(taps), past_.end(), past_.begin());
      at_ = 0;
    }
    value += dot(reversed_.data(), past_.data() + at_, taps);
    past_[at_ + taps] = value;
    ++at_;
  }
}

}  // namespace libchar

// y(t + d) comes from its neighbours through a fractional-delay filter of unit sum (Laakso et al.,
// IEEE Signal Process. Mag. 13 (1996) 30): a sinc behind a Kaiser window, or cubic Lagrange.
#include "libchar/fusion/delay_taps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libchar/core/numeric/whole.hpp"

namespace libchar::fusion {
namespace {

constexpr std::ptrdiff_t kHalf = 12;
constexpr double kKaiser = 8;

// Modified Bessel function of the first kind, order 0, by its series.
double bessel_0(double x) {
  double sum = 1, term = 1;
  for (int k = 1; k < 60; ++k) {
    term *= (x / (2 * k)) * (x / (2 * k));
    sum += term;
  }
  return sum;
}

std::vector<double> sinc_taps(double f) {
  std::vector<double> out;
  double sum = 0;
  for (std::ptrdiff_t k = 1 - kHalf; k <= kHalf; ++k) {
    const double x = f - static_cast<double>(k), u = x / static_cast<double>(kHalf);
    const double angle = std::numbers::pi * x;
    const double sinc = x == 0 ? 1 : std::sin(angle) / angle;
    out.push_back(sinc * bessel_0(kKaiser * std::sqrt(std::max(0.0, 1 - u * u))));
    sum += out.back();
  }
  for (double& w : out) w /= sum;
  return out;
}

std::vector<double> cubic_taps(double f) {
  return {-f * (f - 1) * (f - 2) / 6, (f + 1) * (f - 1) * (f - 2) / 2, -(f + 1) * f * (f - 2) / 2,
          (f + 1) * f * (f - 1) / 6};
}

}  // namespace

DelayTaps::DelayTaps(double delay, Interpolation interpolation)
    : floor(clamped_whole<std::ptrdiff_t>(std::floor(delay))), fraction(delay - std::floor(delay)) {
  if (fraction == 0) {
    weights = {1};
  } else if (interpolation == Interpolation::cubic) {
    weights = cubic_taps(fraction);
    first = -1;
  } else {
    weights = sinc_taps(fraction);
    first = 1 - kHalf;
  }
}

double DelayTaps::at(const double* y, std::ptrdiff_t stride, std::ptrdiff_t size, std::ptrdiff_t t, bool strict) const {
  const std::ptrdiff_t place = t + floor, from = place + first;
  const auto taps = static_cast<std::ptrdiff_t>(weights.size());
  if (from >= 0 && from + taps <= size) {
    double sum = 0;
    for (std::ptrdiff_t k = 0; k < taps; ++k) sum += weights[static_cast<std::size_t>(k)] * y[(from + k) * stride];
    if (std::isfinite(sum)) return sum;
  }
  if (strict || place < 0 || place + 1 >= size) return std::numeric_limits<double>::quiet_NaN();
  return (1 - fraction) * y[place * stride] + fraction * y[(place + 1) * stride];
}

}  // namespace libchar::fusion

#include "libchar/core/numeric/noise_shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace libchar {
namespace {

constexpr double kBelowFirst = 0.957603280698573646;  // a sixteenth of an octave

double boxcar_ratio(double taps, double frequency_hz, double rate_hz) {
  const double half = std::numbers::pi * frequency_hz / rate_hz;
  const double gain = std::sin(taps * half) / (taps * std::sin(half));
  return gain * gain;
}

// Of the nearest point in ln f: so a bin keeps the power that was measured in it.
double measured_ratio(const NoiseShape& shape, double frequency_hz) {
  const std::vector<double>& f = shape.frequency_hz;
  if (f.empty() || frequency_hz < f.front() * kBelowFirst) return 1;
  const auto after = static_cast<std::size_t>(std::upper_bound(f.begin(), f.end(), frequency_hz) - f.begin());
  if (after == 0 || after == f.size()) return shape.ratio[after == 0 ? 0 : after - 1];
  const bool nearer = frequency_hz * frequency_hz < f[after - 1] * f[after];
  return shape.ratio[nearer ? after - 1 : after];
}

}  // namespace

double shape_ratio(const NoiseShape& shape, double frequency_hz, double rate_hz) {
  switch (shape.kind) {
    case NoiseShape::Kind::none:
      return 1;
    case NoiseShape::Kind::boxcar:
      return boxcar_ratio(static_cast<double>(shape.taps), frequency_hz, rate_hz);
    case NoiseShape::Kind::bartlett: {
      const double once = boxcar_ratio(static_cast<double>(shape.taps), frequency_hz, rate_hz);
      return once * once;
    }
    case NoiseShape::Kind::measured:
      return measured_ratio(shape, frequency_hz);
  }
  return 1;
}

}  // namespace libchar

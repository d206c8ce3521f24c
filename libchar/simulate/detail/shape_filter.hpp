#pragma once
// Noise with the density of a shape: a finite impulse response over blocks, by fast convolution.

#include <functional>
#include <span>
#include <vector>

#include "libchar/core/hidden.hpp"
#include "libchar/core/numeric/noise_shape.hpp"

namespace libchar {

/// Impulse response with the shape's gain, of unit sum; boxcar and bartlett exactly, a measured one
/// to within the resolution of its lowest frequency (at most 2^16 taps).
std::vector<double> shape_taps(const NoiseShape& shape, double rate_hz);

class ShapeFilter {
 public:
  /// `source` adds the next samples to zeros. It is asked for one response's length before the
  /// first sample, so that the output is in its steady state from the first sample on.
  ShapeFilter(const NoiseShape& shape,
              double rate_hz,
              std::function<void(std::span<double>)> source);
  /// Adds the next filtered samples; the same whatever the pieces.
  void add(std::span<double> out);

 private:
  struct State;
  detail::Hidden<State> state_;
};

}  // namespace libchar

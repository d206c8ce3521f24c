#pragma once
// One simulated device: the nine blocks of a sensor model, sample by sample.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "libchar/core/hidden.hpp"
#include "libchar/core/numeric/noise_shape.hpp"
#include "libchar/model/sensor_model.hpp"
#include "libchar/simulate/sensor_array.hpp"

namespace libchar {

struct ChainOptions {
  double rate_hz = 0;  ///< at which the chain runs
  std::uint64_t seed = 1;
  std::uint64_t sensor = 0;              ///< keys the random streams of this device
  bool low_pass_starts_at_zero = false;  ///< as published; else in its steady state
  bool deterministic = false;            ///< with the model's deterministic terms
};

class SensorChain {
 public:
  SensorChain(const SensorModel& model, const ChainOptions& options);

  /// Turns the true input `samples`, in place, into what the device gives out. `temperature_degc`
  /// is as long, or empty: the model's reference temperature. A missing input is a missing output.
  void run(std::span<double> samples, std::span<const double> temperature_degc);
  DeviceDraw draw() const;

 private:
  struct State;
  detail::Hidden<State> state_;
};

// Noise with the density of a shape: a finite impulse response over blocks, by fast convolution.

/// Impulse response with the shape's gain, of unit sum; boxcar and bartlett exactly, a measured one to within the
/// resolution of its lowest frequency (at most 2^16 taps; not of unit sum where it goes on below what they resolve).
std::vector<double> shape_taps(const NoiseShape& shape, double rate_hz);

class ShapeFilter {
 public:
  /// `source` adds the next samples to zeros. It is asked for one response's length before the
  /// first sample, so that the output is in its steady state from the first sample on.
  ShapeFilter(const NoiseShape& shape, double rate_hz, std::function<void(std::span<double>)> source);
  /// Adds the next filtered samples; the same whatever the pieces.
  void add(std::span<double> out);

 private:
  struct State;
  detail::Hidden<State> state_;
};

}  // namespace libchar

#pragma once
// One simulated device: the nine blocks of a sensor model, sample by sample.

#include <cstdint>
#include <span>

#include "libchar/core/hidden.hpp"
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

}  // namespace libchar

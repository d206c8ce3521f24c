#pragma once
// Arrays of simulated sensors: y_i = model_i(h_i · x) with known truth x.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libchar/core/hidden.hpp"
#include "libchar/model/sensor_model.hpp"
#include "libchar/simulate/fault.hpp"
#include "libchar/simulate/signal.hpp"

namespace libchar {

struct SimulatedSensor {
  std::string name;  ///< channel name of its samples
  SensorModel model;
  std::vector<double> h = {1};  ///< row of the observation matrix: one weight a truth signal
};

struct ArraySimulation {
  double rate_hz = 0;
  std::uint64_t samples = 0;
  std::uint64_t seed = 1;
  /// signals, noise and filters run at oversampling * rate_hz; every oversampling-th sample is kept
  std::uint64_t oversampling = 1;
  std::vector<SignalSpec> truth = {SignalSpec{}};
  std::vector<std::string> truth_names = {"truth"};
  /// the truth columns are given through the same first-order low-pass as the sensors
  std::optional<double> truth_bandwidth_hz;
  std::optional<SignalSpec> temperature;  ///< degC; none: every model's own reference temperature
  std::vector<SimulatedSensor> sensors;
  std::vector<SensorFault> faults;
  /// as published; else in the steady state of the first sample
  bool low_pass_starts_at_zero = false;
  /// with the steps, warm-ups and ramps of the recordings that the models are from
  bool deterministic = false;
};

/// Throws Error(input) with one sentence when the parts do not fit together (no sensors, h of
/// another length than truth, equal names, fault of no sensor…).
void check(const ArraySimulation& simulation);

/// What one device drew once: scale factor and bias at the reference temperature.
struct DeviceDraw {
  double scale_factor = 1, bias = 0;
};

/// Streams the array: memory does not grow with the length, results depend neither on the block
/// size nor on the number of threads.
class ArraySimulator {
 public:
  explicit ArraySimulator(const ArraySimulation& simulation, int threads = 1);

  /// Columns of the next block: the sensors, then the truth signals, then the temperature if there
  /// is one. Empty at the end. Valid until the next call.
  std::span<const std::span<const double>> next(std::size_t rows);
  const std::vector<DeviceDraw>& draws() const;

 private:
  struct State;
  detail::Hidden<State> state_;
};

}  // namespace libchar

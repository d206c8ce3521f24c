#include <cmath>
#include <limits>

#include "libchar/benchmark/detail/estimators.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/simulate/sensor_array.hpp"

namespace libchar {
namespace {

/// The model without what is no noise: a record of it is what an estimator gets.
SensorModel noise_alone(const SensorModel& model) {
  SensorModel out = model;
  out.scale_factor = {};
  out.nonlinearity = {};
  out.bias = {};
  out.sensitivity = {};
  out.saturation_low = out.saturation_high = std::nullopt;
  return out;
}

}  // namespace

Mixture truth_of(const SensorModel& model) {
  Mixture theta{};
  for (std::size_t i = 0; i < kTerms; ++i) {
    const double value = simulated_value(model.noise[i]);
    theta[i] = value * value;
  }
  return theta;
}

std::vector<double> record_of(const BenchSignal& signal, std::uint64_t seed) {
  return mean_of_records(signal, 1, seed);
}

std::vector<double> mean_of_records(const BenchSignal& signal, std::uint64_t sensors, std::uint64_t seed) {
  ArraySimulation simulation;
  simulation.rate_hz = signal.rate_hz;
  simulation.samples = signal.samples;
  simulation.seed = seed;
  for (std::uint64_t s = 0; s < sensors; ++s)
    simulation.sensors.push_back({"s" + std::to_string(s), noise_alone(signal.model)});
  ArraySimulator simulator(simulation, 1);
  constexpr std::size_t kRows = 65536;
  std::vector<double> out;
  out.reserve(detail::in_memory(signal.samples));
  const double share = 1 / static_cast<double>(sensors);
  for (auto columns = simulator.next(kRows); !columns.empty() && !columns[0].empty(); columns = simulator.next(kRows))
    for (std::size_t i = 0; i < columns[0].size(); ++i) {
      double sum = 0;
      for (std::size_t s = 0; s < sensors; ++s) sum += columns[s][i];
      out.push_back(sum * share);
    }
  return out;
}

std::vector<double> front_gaps(const std::vector<CostAndError>& points) {
  std::vector<double> gaps(points.size(), std::numeric_limits<double>::quiet_NaN());
  const auto counts = [](const CostAndError& p) { return !std::isnan(p.cost) && !std::isnan(p.error); };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!counts(points[i])) continue;
    double least = points[i].error;
    for (const CostAndError& other : points)
      if (counts(other) && other.cost <= points[i].cost && other.error < least) least = other.error;
    gaps[i] = least == points[i].error ? 0 : points[i].error / least - 1;
  }
  return gaps;
}

}  // namespace libchar

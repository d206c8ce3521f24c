// y_i[k] = model_i(sum_j h_ij x_j(t_k)), block by block: truth signals first, then every sensor on its own streams of
// random numbers, then faults. With oversampling p everything up to the quantization runs p times as fast and every
// p-th sample is kept, so that aliases are in the samples.
#include "libchar/simulate/sensor_array.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/parallel/thread_limit.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/simulate/detail/sensor_chain.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kTemperatureIndex = 1U << 20U;  // its random stream, away from the truths'

/// All that is made is drawn, also what is renewed before a sample has seen it.
constexpr double kMostRenewals = 1000;

void check_hold(const char* key, const std::optional<double>& hold_s, const std::string& sensor, double rate_hz) {
  if (!hold_s || *hold_s * rate_hz * kMostRenewals >= 1) return;
  throw input_error("E0554")
      .says("sensor {}: {} of {} s renews the noise more than {} times between two samples", sensor, key, *hold_s,
            kMostRenewals)
      .hint("leave {} out: noise is then new for each sample", key);
}

void check_sensor(const ArraySimulation& s, const SimulatedSensor& sensor) {
  if (sensor.h.size() != s.truth.size())
    throw input_error("E0554").says("sensor {} weighs {} truth signals, and there are {}", sensor.name, sensor.h.size(),
                                    s.truth.size());
  const double rate = s.rate_hz * static_cast<double>(s.oversampling);
  if (sensor.model.bandwidth_hz && *sensor.model.bandwidth_hz > 10 * rate)
    throw input_error("E0554")
        .says("sensor {}: a bandwidth of {} is far above the rate of {}", sensor.name,
              detail::frequency_text(*sensor.model.bandwidth_hz, 6), rate)
        .hint("leave bandwidth_hz out: nothing of it would be seen");
  check_hold("white_hold_s", sensor.model.white_hold_s, sensor.name, rate);
  check_hold("flicker_hold_s", sensor.model.flicker_hold_s, sensor.name, rate);
}

void check_signals(const ArraySimulation& s) {
  for (std::size_t j = 0; j < s.truth.size(); ++j) {
    const SignalSpec& signal = s.truth[j];
    const bool derived = signal.kind == "derivative" || signal.kind == "sine_of" || signal.kind == "cosine_of";
    if (derived && signal.of >= j)
      throw input_error("E0554").says("truth signal {} is derived from signal {}, which must be listed before it", j,
                                      signal.of);
    if (signal.kind == "points" && signal.points.empty())
      throw input_error("E0554").says("a signal of points has none");
    if (signal.kind == "recording" && signal.samples.empty())
      throw input_error("E0554").says("a signal from a recording has no samples");
    if (signal.kind == "recording" && s.oversampling > 1)
      throw input_error("E0554")
          .says("a signal from a recording cannot be oversampled")
          .hint("leave oversampling at 1");
  }
}

// The first-order low-pass of the truth columns, as in sensor_chain.cpp.
struct LowPass {
  double memory = 0, state = 0;
  bool started = false, from_zero = false;
  void run(std::span<double> x) {
    for (double& v : x) {
      if (std::isnan(v)) continue;
      if (!started) state = from_zero ? 0 : v;
      started = true;
      state = memory * state + (1 - memory) * v;
      v = state;
    }
  }
};

void keep_every(std::span<const double> fine, std::size_t step, std::span<double> coarse) {
  for (std::size_t k = 0; k < coarse.size(); ++k) coarse[k] = fine[k * step];
}

}  // namespace

void check(const ArraySimulation& s) {
  if (s.sensors.empty()) throw input_error("E0554").says("there is no sensor to simulate");
  if (!(s.rate_hz >= 1e-9 && s.rate_hz <= 1e12))
    throw input_error("E0554").says("the sampling rate must be above 0 Hz: from 1 nHz to 1 THz");
  if (s.samples == 0)
    throw input_error("E0554").says("there is no sample to simulate").hint("give a duration or a number of samples");
  if (s.oversampling == 0 || s.oversampling > 1024)
    throw input_error("E0554").says("oversampling must be from 1 to 1024");
  if (s.truth.empty() || s.truth.size() != s.truth_names.size())
    throw input_error("E0554").says("every truth signal needs a name, and there must be one");
  check_signals(s);
  std::set<std::string> names(s.truth_names.begin(), s.truth_names.end());
  if (names.size() != s.truth_names.size()) throw input_error("E0554").says("two truth signals have one name");
  for (const SimulatedSensor& sensor : s.sensors) {
    if (!names.insert(sensor.name).second)
      throw input_error("E0554")
          .says("two channels would be called {}", sensor.name)
          .hint(
              "rename the sensor (channel: in a model, name: in a scene); a truth signal is called truth unless it has "
              "a name");
    check_sensor(s, sensor);
  }
  for (const SensorFault& fault : s.faults)
    if (fault.sensor >= s.sensors.size())
      throw input_error("E0554").says("a fault is of sensor {}, and there are {}", fault.sensor, s.sensors.size());
}

struct ArraySimulator::State {
  ArraySimulation spec;
  int threads = 1;
  std::uint64_t done = 0;
  std::vector<std::unique_ptr<SignalSource>> signals;
  std::unique_ptr<SignalSource> temperature;
  std::vector<LowPass> truth_low_pass;
  std::vector<SensorChain> chains;
  std::vector<FaultInjector> faults;
  std::vector<DeviceDraw> draws;
  std::vector<std::vector<double>> fine_truth, fine_sensor, truth, sensor;
  std::vector<double> fine_temperature, coarse_temperature;
  std::vector<std::span<const double>> columns;

  State(const ArraySimulation& simulation, int n) : spec(simulation), threads(n) {
    check(spec);
    const double rate = spec.rate_hz * static_cast<double>(spec.oversampling);
    const std::uint64_t length = spec.samples * spec.oversampling;
    for (std::size_t j = 0; j < spec.truth.size(); ++j)
      signals.push_back(make_signal(spec.truth[j], rate, length, spec.seed, j));
    if (spec.temperature) temperature = make_signal(*spec.temperature, rate, length, spec.seed, kTemperatureIndex);
    if (spec.truth_bandwidth_hz) {
      const double a = std::exp(-2 * std::numbers::pi * *spec.truth_bandwidth_hz / rate);
      truth_low_pass.assign(spec.truth.size(), LowPass{a, 0, false, spec.low_pass_starts_at_zero});
    }
    for (std::size_t i = 0; i < spec.sensors.size(); ++i) {
      chains.emplace_back(spec.sensors[i].model,
                          ChainOptions{rate, spec.seed, i, spec.low_pass_starts_at_zero, spec.deterministic});
      draws.push_back(chains.back().draw());
      std::vector<SensorFault> own;
      for (const SensorFault& fault : spec.faults)
        if (fault.sensor == i) own.push_back(fault);
      faults.emplace_back(std::move(own), spec.rate_hz, spec.seed, i);
    }
    fine_truth.resize(spec.truth.size());
    truth.resize(spec.truth.size());
    fine_sensor.resize(spec.sensors.size());
    sensor.resize(spec.sensors.size());
  }

  void make_truth(std::size_t rows) {
    const std::size_t fine = rows * detail::in_memory(spec.oversampling);
    std::vector<std::span<const double>> earlier;
    for (std::size_t j = 0; j < signals.size(); ++j) {
      fine_truth[j].resize(fine);
      signals[j]->next(fine_truth[j], earlier);
      earlier.emplace_back(fine_truth[j]);
    }
    if (temperature) {
      fine_temperature.resize(fine);
      temperature->next(fine_temperature, earlier);
      coarse_temperature.resize(rows);
      keep_every(fine_temperature, detail::in_memory(spec.oversampling), coarse_temperature);
    }
  }

  void run_sensor(std::size_t i, std::size_t rows) {
    const std::vector<double>& h = spec.sensors[i].h;
    std::vector<double>& y = fine_sensor[i];
    y.assign(rows * detail::in_memory(spec.oversampling), 0.0);
    for (std::size_t j = 0; j < h.size(); ++j) {
      if (h[j] == 0) continue;
      const std::vector<double>& x = fine_truth[j];
      if (h[j] == 1) {
        for (std::size_t k = 0; k < y.size(); ++k) y[k] += x[k];
      } else {
        for (std::size_t k = 0; k < y.size(); ++k) y[k] += h[j] * x[k];
      }
    }
    chains[i].run(y, fine_temperature);
    sensor[i].resize(rows);
    keep_every(y, detail::in_memory(spec.oversampling), sensor[i]);
    faults[i].apply(sensor[i]);
  }

  void finish_truth(std::size_t rows) {
    for (std::size_t j = 0; j < truth.size(); ++j) {
      if (!truth_low_pass.empty()) truth_low_pass[j].run(fine_truth[j]);
      truth[j].resize(rows);
      keep_every(fine_truth[j], detail::in_memory(spec.oversampling), truth[j]);
    }
  }
};

ArraySimulator::ArraySimulator(const ArraySimulation& simulation, int threads)
    : state_(detail::hidden<State>(simulation, threads)) {}

std::span<const std::span<const double>> ArraySimulator::next(std::size_t wanted) {
  State& s = *state_;
  const auto rows = static_cast<std::size_t>(std::min<std::uint64_t>(wanted, s.spec.samples - s.done));
  s.columns.clear();
  if (rows == 0) return s.columns;
  s.make_truth(rows);
  if (s.threads == 1 || s.chains.size() == 1) {
    for (std::size_t i = 0; i < s.chains.size(); ++i) s.run_sensor(i, rows);
  } else {
    parallel::Threads arena(s.threads > 0 ? std::min(s.threads, processors_given()) : processors_given());
    arena.run([&] { parallel::for_each(0, s.chains.size(), [&](std::size_t i) { s.run_sensor(i, rows); }); });
  }
  s.finish_truth(rows);
  s.done += rows;
  count_work(WorkKind::simulated_samples, rows * s.chains.size());
  if (s.done == s.spec.samples) count_work(WorkKind::passes, 1);
  for (const auto& column : s.sensor) s.columns.emplace_back(column);
  for (const auto& column : s.truth) s.columns.emplace_back(column);
  if (s.temperature) s.columns.emplace_back(s.coarse_temperature);
  return s.columns;
}

const std::vector<DeviceDraw>& ArraySimulator::draws() const { return state_->draws; }

}  // namespace libchar

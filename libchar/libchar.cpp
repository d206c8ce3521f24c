#include "libchar/libchar.hpp"

#include <cmath>

#include "libchar/core/numeric/whole.hpp"

namespace libchar {
namespace {

constexpr std::size_t kBlock = 1 << 14;  // samples of a channel simulated at once

LogInfo info_of(const ArraySimulation& array) {
  LogInfo info;
  info.file = "simulation";
  info.samples = info.rows = array.samples;
  info.time.rate_hz = array.rate_hz;
  for (const SimulatedSensor& sensor : array.sensors) {
    const std::string& own = sensor.model.sensitivity.unit;
    info.channels.push_back({sensor.name, own.empty() ? sensor.model.unit : own, false});
  }
  const std::string unit = array.truth.size() == 1 ? array.sensors[0].model.unit : "";
  for (const std::string& name : array.truth_names) info.channels.push_back({name, unit, false});
  if (array.temperature) info.channels.push_back({"temperature", "degC", false});
  return info;
}

}  // namespace

NoiseFit fit(std::span<const double> record, double rate_hz, const FitOptions& options) {
  if (!options.second_opinion) return fit_record(record, rate_hz, nullptr, options);
  const AllanCurve curve = allan_deviation(record, 1 / rate_hz);
  return fit_record(record, rate_hz, &curve, options);
}

std::vector<SensorModel> sensor_models(const Characterization& result) {
  std::vector<SensorModel> models;
  for (const ChannelResult& c : result.channels)
    if (c.fit) models.push_back(sensor_model_from(c, result.log));
  return models;
}

Recording simulate(const SensorModel& model, const SimulateOptions& options) {
  ArraySimulation array;
  array.rate_hz = options.rate_hz > 0 ? options.rate_hz : model.rate_hz;
  array.samples = clamped_whole<std::uint64_t>(std::round(options.duration_s * array.rate_hz));
  array.seed = options.seed;
  array.truth = {options.truth};
  array.faults = options.faults;
  const std::string name = model.channel.empty() ? "sensor" : model.channel;
  for (std::uint64_t i = 1; i <= options.devices; ++i)
    array.sensors.push_back({options.devices == 1 ? name : name + std::to_string(i), model, {1}});
  return simulate(array);
}

Recording simulate(const ArraySimulation& array) {
  check(array);
  Recording recording{info_of(array), {}};
  recording.samples.resize(recording.info.channels.size());
  ArraySimulator simulator(array);
  for (auto block = simulator.next(kBlock); !block.empty(); block = simulator.next(kBlock))
    for (std::size_t c = 0; c < block.size(); ++c)
      recording.samples[c].insert(recording.samples[c].end(), block[c].begin(), block[c].end());
  return recording;
}

void write_recording(const std::string& path, const Recording& recording, const WriteOptions& options) {
  const auto writer = open_log_writer(path, recording.info, options);
  const std::vector<std::span<const double>> columns(recording.samples.begin(), recording.samples.end());
  writer->write(columns);
  writer->finish();
}

Export export_models(std::string_view target, const std::vector<SensorModel>& models, const ExportOptions& options) {
  return export_models(find_export_target(target), models, options);
}

}  // namespace libchar

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/log/read.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/scene/simulated_scene.hpp"

namespace libchar {
namespace {

std::string name_of_sensor(const SensorModel& model, const std::string& path) {
  if (!model.channel.empty()) return model.channel;
  const std::string stem = std::filesystem::path(path).filename().string();
  return stem.substr(0, stem.find('.'));
}

// Devices of one model are numbered; equal names of several files get their number too.
void add_devices(ArraySimulation& simulation, const SensorModel& model, const std::string& name,
                 std::uint64_t devices) {
  std::set<std::string> taken;
  for (const SimulatedSensor& sensor : simulation.sensors) taken.insert(sensor.name);
  for (std::uint64_t i = 1; i <= devices; ++i) {
    std::string own = devices == 1 ? name : name + std::to_string(i);
    for (int again = 2; !taken.insert(own).second; ++again) own = fmt::format("{}_{}", name, again);
    simulation.sensors.push_back({own, model, {1}});
  }
}

}  // namespace

ArraySimulation simulation_of_models(const std::vector<std::string>& model_files,
                                     const ModelSimulationOptions& options) {
  ArraySimulation simulation;
  for (const std::string& path : model_files)
    for (const SensorModel& model : read_model_list(path)) {
      if (simulation.rate_hz == 0) simulation.rate_hz = model.rate_hz;
      if (!options.rate_hz && model.rate_hz != simulation.rate_hz)
        throw usage_error("E0721", path)
            .says("is a model at {} and the one before at {}", detail::frequency_text(model.rate_hz, 6),
                  detail::frequency_text(simulation.rate_hz, 6))
            .hint("give one `rate_hz` for all");
      add_devices(simulation, model, name_of_sensor(model, path), options.devices);
    }
  if (options.rate_hz) simulation.rate_hz = *options.rate_hz;
  return simulation;
}

void read_recorded_signal(SignalSpec& signal, const std::string& place, const ArraySimulation& simulation,
                          Findings& warnings) {
  if (signal.kind != "recording") return;
  const auto refusal = [&]() { return usage_error("E0721", place).got(signal.file); };
  ReadOptions reading;
  reading.hash = false;
  if (!signal.channel.empty()) reading.channels = {signal.channel};
  Recording log = read_recording(signal.file, reading);
  if (log.samples.size() != 1)
    throw refusal().says("the recording holds {} channels", log.samples.size()).hint("name one: channel=NAME");
  const double rate = log.info.time.rate_hz;
  if (rate > 0 && std::abs(rate / simulation.rate_hz - 1) > 1e-4)
    throw refusal()
        .says("the recording has {}, and the simulation runs at {}", detail::frequency_text(rate, 6),
              detail::frequency_text(simulation.rate_hz, 6))
        .hint("`rate_hz` " + shortest(rounded(rate, 6)));
  signal.samples = std::move(log.samples[0]);
  if (signal.samples.empty()) throw refusal().says("the recording holds no sample");
  if (signal.samples.size() < simulation.samples)
    warnings.add("recorded_signal_short", "a recorded signal ends before the simulation; its last sample is held",
                 place);
}

}  // namespace libchar

#include "libchar/scene/simulated_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/scene/scene_file.hpp"

namespace libchar {
std::string output_unit(const SensorModel& model) {
  return model.sensitivity.unit.empty() ? model.unit : model.sensitivity.unit;
}

namespace {

// The weights of the inputs that the reference names, out of those of all true inputs.
std::vector<double> weights_of(const SceneReference& reference, const std::vector<double>& h,
                               const ArraySimulation& simulation) {
  std::vector<double> row;
  const auto& names = simulation.truth_names;
  for (const std::string& channel : reference.channels)
    row.push_back(h[std::find(names.begin(), names.end(), channel) - names.begin()]);
  return row;
}

// What is in the log: sensors, then true inputs, then temperature.
LogInfo log_info(const ArraySimulation& simulation, const SimulatedRecording& recording) {
  LogInfo info;
  info.file = recording.file;
  info.samples = info.rows = simulation.samples;
  info.time.rate_hz = simulation.rate_hz;
  for (const SimulatedSensor& sensor : simulation.sensors)
    info.channels.push_back({sensor.name, output_unit(sensor.model), false});
  if (!recording.truth) return info;
  for (const std::string& name : simulation.truth_names)
    info.channels.push_back({name, simulation.truth.size() == 1 ? simulation.sensors[0].model.unit : "", false});
  if (simulation.temperature) info.channels.push_back({"temperature", "degC", false});
  return info;
}

// What a log of this format does not say of itself.
ReadOptions reading_of(const ArraySimulation& simulation, const SimulatedRecording& recording) {
  ReadOptions reading;
  const LogFormat format = format_to_write(recording.file, recording.writing);
  const bool stamps = writes_stamps(recording.file, recording.writing);
  if (!format.writes_rate && !stamps) reading.rate_hz = simulation.rate_hz;
  if (format.writes_stamps && !stamps) reading.time_column = "none";
  if (!format.writes_names)
    for (const Channel& channel : log_info(simulation, recording).channels) {
      reading.names.push_back(channel.name);
      reading.units.push_back(channel.unit.empty() ? "1" : channel.unit);
    }
  return reading;
}

// All that makes the log again.
SimulatedFrom simulated_from(const ArraySimulation& simulation, const SimulatedRecording& recording,
                             const Scene& scene) {
  SimulatedFrom out;
  out.seed = simulation.seed;
  out.faults = simulation.faults;
  out.oversampling = simulation.oversampling;
  out.truth_columns = recording.truth;
  out.deterministic = simulation.deterministic;
  out.command = recording.command;
  out.simulation = simulation;
  const auto weighed_otherwise = [&](std::size_t i) { return simulation.sensors[i].h != scene.sensors[i].h; };
  for (std::size_t i = 0; i < scene.sensors.size() && out.rows.empty(); ++i)
    if (weighed_otherwise(i))
      for (const SimulatedSensor& sensor : simulation.sensors)
        out.rows.insert(out.rows.end(), sensor.h.begin(), sensor.h.end());
  return out;
}

// Channels by name, models inline, the truth as reference. What the scene that was simulated said of its replay
// (windows, algorithms, levels of noise) is kept from `original`.
Scene replay_scene(const ArraySimulation& simulation, const SimulatedRecording& recording, const Scene& original) {
  Scene scene;
  scene.learning = original.learning;
  scene.evaluation = original.evaluation;
  scene.rest = original.rest;
  scene.fault_free_s = original.fault_free_s;
  scene.warm_up_s = original.warm_up_s;
  scene.tilt = original.tilt;
  scene.align = original.align;
  scene.preparation = original.preparation;
  scene.algorithms = original.algorithms;
  scene.file = recording.scene_file;
  scene.name = std::filesystem::path(recording.file).stem().string();
  scene.recording = recording.file;
  scene.reading = reading_of(simulation, recording);
  for (const SimulatedSensor& sensor : simulation.sensors)
    scene.sensors.push_back({sensor.name, sensor.name, sensor.model, sensor.h});
  for (std::size_t i = 0; i < original.sensors.size(); ++i) scene.sensors[i].noise = original.sensors[i].noise;
  if (recording.truth) {
    scene.reference = original.reference.value_or(SceneReference{simulation.truth_names, false, {}, {}, 0, false});
    for (SceneSensor& sensor : scene.sensors) sensor.h = weights_of(*scene.reference, sensor.h, simulation);
  }
  scene.simulated = simulated_from(simulation, recording, scene);
  return scene;
}

constexpr std::size_t kRows = std::size_t{1} << 14U;

void check_columns(const ArraySimulation& simulation, bool truth) {
  if (!truth || !simulation.temperature) return;
  std::vector<std::string> names = simulation.truth_names;
  for (const SimulatedSensor& sensor : simulation.sensors) names.push_back(sensor.name);
  if (std::find(names.begin(), names.end(), "temperature") != names.end())
    throw usage_error("E0721", "simulate").says("a channel has the name of the temperature column").got("temperature");
}

void stream_into(LogWriter& writer, const ArraySimulation& simulation, bool truth, Progress& progress) {
  ArraySimulator simulator(simulation, 0);
  const std::size_t sensors = simulation.sensors.size();
  std::uint64_t done = 0;
  for (auto block = simulator.next(kRows); !block.empty(); block = simulator.next(kRows)) {
    progress.update(static_cast<double>(done) / static_cast<double>(simulation.samples), "simulating");
    writer.write(truth ? block : block.first(sensors));
    done += block[0].size();
  }
}

}  // namespace

SimulatedLog simulate_log(const ArraySimulation& simulation, const SimulatedRecording& recording, const Scene& original,
                          Progress& progress) {
  check(simulation);
  check_columns(simulation, recording.truth);
  const LogInfo info = log_info(simulation, recording);
  const auto writer = open_log_writer(recording.file, info, recording.writing);
  std::optional<WholeFile> scene;
  if (!recording.scene_file.empty()) {
    scene.emplace(recording.scene_file, recording.writing.overwrite);
    scene->write(scene_yaml(replay_scene(simulation, recording, original)));
  }
  stream_into(*writer, simulation, recording.truth, progress);
  progress.update(1, "writing " + recording.file);  // the last chance to be stopped
  std::vector<WholeFile*> outputs = writer->complete();
  if (scene) outputs.push_back(&*scene);
  commit_together(outputs);
  SimulatedLog out{ArraySimulator(simulation).draws(), writer->files(), info.channels.size()};
  if (scene) out.files.push_back(recording.scene_file);
  return out;
}

Findings late_faults(const ArraySimulation& simulation) {
  Findings warnings;
  const double end_s = static_cast<double>(simulation.samples) / simulation.rate_hz;
  for (const SensorFault& fault : simulation.faults)
    if (fault.from_s >= end_s)
      warnings.add("fault_after_end", "a fault begins after the end of the recording and changes nothing",
                   fmt::format("{} from {} s, the end is at {} s", simulation.sensors[fault.sensor].name,
                               brief_text(fault.from_s, 6), brief_text(end_s, 6)));
  return warnings;
}

}  // namespace libchar

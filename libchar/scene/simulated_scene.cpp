#include "libchar/scene/simulated_scene.hpp"

#include <algorithm>
#include <filesystem>

namespace libchar {
namespace {

// The weights of the inputs that the reference names, out of those of all true inputs.
std::vector<double> weights_of(const SceneReference& reference,
                               const std::vector<double>& h,
                               const ArraySimulation& simulation) {
  std::vector<double> row;
  const auto& names = simulation.truth_names;
  for (const std::string& channel : reference.channels)
    row.push_back(h[std::find(names.begin(), names.end(), channel) - names.begin()]);
  return row;
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
SimulatedFrom simulated_from(const ArraySimulation& simulation,
                             const SimulatedRecording& recording,
                             const Scene& scene) {
  SimulatedFrom out;
  out.seed = simulation.seed;
  out.faults = simulation.faults;
  out.oversampling = simulation.oversampling;
  out.truth_columns = recording.truth;
  out.deterministic = simulation.deterministic;
  out.command = recording.command;
  out.simulation = simulation;
  const auto weighed_otherwise = [&](std::size_t i) {
    return simulation.sensors[i].h != scene.sensors[i].h;
  };
  for (std::size_t i = 0; i < scene.sensors.size() && out.rows.empty(); ++i)
    if (weighed_otherwise(i))
      for (const SimulatedSensor& sensor : simulation.sensors)
        out.rows.insert(out.rows.end(), sensor.h.begin(), sensor.h.end());
  return out;
}

}  // namespace

std::string output_unit(const SensorModel& model) {
  return model.sensitivity.unit.empty() ? model.unit : model.sensitivity.unit;
}

LogInfo log_info(const ArraySimulation& simulation, const SimulatedRecording& recording) {
  LogInfo info;
  info.file = recording.file;
  info.samples = info.rows = simulation.samples;
  info.time.rate_hz = simulation.rate_hz;
  for (const SimulatedSensor& sensor : simulation.sensors)
    info.channels.push_back({sensor.name, output_unit(sensor.model), false});
  if (!recording.truth) return info;
  for (const std::string& name : simulation.truth_names)
    info.channels.push_back(
        {name, simulation.truth.size() == 1 ? simulation.sensors[0].model.unit : "", false});
  if (simulation.temperature) info.channels.push_back({"temperature", "degC", false});
  return info;
}

Scene replay_scene(const ArraySimulation& simulation,
                   const SimulatedRecording& recording,
                   const Scene& original) {
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
  for (std::size_t i = 0; i < original.sensors.size(); ++i)
    scene.sensors[i].noise = original.sensors[i].noise;
  if (recording.truth) {
    scene.reference = original.reference.value_or(
        SceneReference{simulation.truth_names, false, {}, {}, 0, false});
    for (SceneSensor& sensor : scene.sensors)
      sensor.h = weights_of(*scene.reference, sensor.h, simulation);
  }
  scene.simulated = simulated_from(simulation, recording, scene);
  return scene;
}

}  // namespace libchar

#include "libchar/scene/simulated_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/log/write.hpp"
#include "libchar/scene/text/scene_writer.hpp"

namespace libchar {
namespace {

constexpr std::size_t kRows = std::size_t{1} << 14U;

void check_columns(const ArraySimulation& simulation, bool truth) {
  if (!truth || !simulation.temperature) return;
  std::vector<std::string> names = simulation.truth_names;
  for (const SimulatedSensor& sensor : simulation.sensors) names.push_back(sensor.name);
  if (std::find(names.begin(), names.end(), "temperature") != names.end())
    throw usage_error("E0721", "simulate")
        .says("a channel has the name of the temperature column")
        .got("temperature");
}

void stream_into(LogWriter& writer,
                 const ArraySimulation& simulation,
                 bool truth,
                 Progress& progress) {
  ArraySimulator simulator(simulation, 0);
  const std::size_t sensors = simulation.sensors.size();
  std::uint64_t done = 0;
  for (auto block = simulator.next(kRows); !block.empty(); block = simulator.next(kRows)) {
    progress.update(static_cast<double>(done) / static_cast<double>(simulation.samples),
                    "simulating");
    writer.write(truth ? block : block.first(sensors));
    done += block[0].size();
  }
}

}  // namespace

SimulatedLog simulate_log(const ArraySimulation& simulation,
                          const SimulatedRecording& recording,
                          const Scene& original,
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
      warnings.add("fault_after_end",
                   "a fault begins after the end of the recording and changes nothing",
                   fmt::format("{} from {} s, the end is at {} s",
                               simulation.sensors[fault.sensor].name,
                               brief_text(fault.from_s, 6),
                               brief_text(end_s, 6)));
  return warnings;
}

}  // namespace libchar

#pragma once
// A log with known truth, and the scene that replays it: one set, written together.

#include <string>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/core/process/progress.hpp"
#include "libchar/scene/scene.hpp"
#include "libchar/scene/simulated_scene.hpp"
#include "libchar/simulate/sensor_array.hpp"

namespace libchar {

/// What a simulation wrote.
struct SimulatedLog {
  std::vector<DeviceDraw> draws;   ///< one per sensor
  std::vector<std::string> files;  ///< the log first
  std::size_t channels = 0;        ///< of the log
};

/// Streams the simulation into `recording.file`, in constant memory, and writes the scene that
/// replays it; no `scene_file`: the log alone. What `original` says of a replay is kept. Both files
/// are there, or neither. Throws as check(ArraySimulation) and open_log_writer, and Error(usage)
/// where a channel has the name of another column.
SimulatedLog simulate_log(const ArraySimulation& simulation,
                          const SimulatedRecording& recording,
                          const Scene& original = {},
                          Progress& progress = no_progress());

/// Of faults that begin after the end of the recording.
Findings late_faults(const ArraySimulation& simulation);

}  // namespace libchar

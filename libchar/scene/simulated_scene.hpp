#pragma once
// The scene that replays what a simulation wrote.

#include <string>

#include "libchar/log/write.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {

/// A recording that a simulation writes.
struct SimulatedRecording {
  std::string file;        ///< of the log
  std::string scene_file;  ///< of the scene that replays it
  WriteOptions writing;    ///< of the log
  bool truth = true;       ///< with the columns of the true inputs and of the temperature
  std::vector<std::string> command = {};  ///< that asks for it, without the program
};

/// The unit of a sensor's output.
std::string output_unit(const SensorModel& model);

/// What is in the log: sensors, then true inputs, then temperature.
LogInfo log_info(const ArraySimulation& simulation, const SimulatedRecording& recording);

/// Channels by name, models inline, the truth as reference. What the scene that was simulated said
/// of its replay (windows, algorithms, levels of noise) is kept from `original`.
Scene replay_scene(const ArraySimulation& simulation,
                   const SimulatedRecording& recording,
                   const Scene& original);

}  // namespace libchar

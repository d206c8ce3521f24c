#pragma once
// The scene that replays what a simulation wrote.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/core/process/progress.hpp"
#include "libchar/log/write.hpp"
#include "libchar/scene/scene.hpp"
#include "libchar/simulate/sensor_array.hpp"

namespace libchar {

/// A recording that a simulation writes.
struct SimulatedRecording {
  std::string file;                       ///< of the log
  std::string scene_file;                 ///< of the scene that replays it
  WriteOptions writing;                   ///< of the log
  bool truth = true;                      ///< with the columns of the true inputs and of the temperature
  std::vector<std::string> command = {};  ///< that asks for it, without the program
};

/// The unit of a sensor's output.
std::string output_unit(const SensorModel& model);

// A log with known truth, and the scene that replays it: one set, written together.

/// What a simulation wrote.
struct SimulatedLog {
  std::vector<DeviceDraw> draws;   ///< one per sensor
  std::vector<std::string> files;  ///< the log first
  std::size_t channels = 0;        ///< of the log
};

/// Streams the simulation into `recording.file`, in constant memory, and writes the scene that replays it; no
/// `scene_file`: the log alone. What `original` says of a replay is kept. Both files are there, or neither. Throws as
/// check(ArraySimulation) and open_log_writer, and Error(usage) where a channel has the name of another column.
SimulatedLog simulate_log(const ArraySimulation& simulation, const SimulatedRecording& recording,
                          const Scene& original = {}, Progress& progress = no_progress());

/// Of faults that begin after the end of the recording.
Findings late_faults(const ArraySimulation& simulation);

// A simulation of the sensors that model files describe, without a scene.

struct ModelSimulationOptions {
  std::optional<double> rate_hz;  ///< none: the models', which then have to agree
  std::uint64_t devices = 1;      ///< of each model, each with its own draws; numbered from 1
};

/// Reads the models; sensors are named by their channel, else by their file. How long, and what is measured, is left to
/// the caller. Throws Error(usage) when the models state several rates, and what reading a model throws.
ArraySimulation simulation_of_models(const std::vector<std::string>& model_files,
                                     const ModelSimulationOptions& options = {});

// The samples of a true signal that comes from a log.

/// Reads the log of a signal of kind recording into it, and leaves every other kind as it is. The path is used
/// unchanged, not relative to a scene. A log that is shorter than the simulation is a warning; one of another rate,
/// with several channels or without a sample is Error(usage) at `place`.
void read_recorded_signal(SignalSpec& signal, const std::string& place, const ArraySimulation& simulation,
                          Findings& warnings);

}  // namespace libchar

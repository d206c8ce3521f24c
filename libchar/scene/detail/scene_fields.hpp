#pragma once
// The keys of a scene file, block by block: what its reader, its writer and docs/scenes.md share.

#include <optional>
#include <string>

#include "libchar/core/document/fields.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {

/// A whole scene: most of its keys are blocks with rows of their own.
const Fields<Scene>& scene_fields();

/// Those of them about time and about what all sensors go through alike.
const Fields<Scene>& scene_time_fields();

/// A sensor; `count` makes several devices of one model.
const Fields<SceneSensor>& sensor_fields();

/// The block `reference`, when it is a map.
const Fields<SceneReference>& reference_fields();

/// The block `align`.
const Fields<SceneAlign>& align_fields();

/// A fault as a file has it: the sensor by name, the end open.
struct FaultText {
  std::string sensor;
  FaultKind kind = FaultKind::bias;
  std::optional<double> value;
  double from_s = 0;
  std::optional<double> to_s;
};
const Fields<FaultText>& fault_fields();

/// The block `simulate`, without its length, its signals, its sensors and its faults.
const Fields<ArraySimulation>& simulation_fields();

/// The numbers of a signal; a kind has those of signal_keys(kind).
const Fields<SignalSpec>& signal_fields();

/// "| kind | keys | signal |" in Markdown, a row a kind.
std::string signal_kinds_table();

/// How the recording of a scene is to be read, beside its file.
const Fields<ReadOptions>& scene_reading_fields();

/// What a simulated recording is known to hold, without its faults.
const Fields<SimulatedFrom>& simulated_fields();

/// What `tilt` names.
struct TiltText {
  std::string gyroscope, accelerometer_x, accelerometer_z;
};
const Fields<TiltText>& tilt_fields();

/// Is the size of a fault of this kind of no meaning?
bool is_valueless(FaultKind kind);

}  // namespace libchar

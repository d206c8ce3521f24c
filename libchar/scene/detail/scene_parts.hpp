#pragma once
// The readers of a scene's parts, for the reader of the file alone.

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/schema.hpp"
#include "libchar/scene/scene.hpp"
#include "libchar/scene/scene_paths.hpp"

namespace libchar {

// ---- refusals ----

/// Throws Error(input): "WHERE: error CODE: KEY: WHAT".
[[noreturn]] void refuse_scene(const char* code,
                               const MapReader& at,
                               std::string_view key,
                               const std::string& what,
                               const std::string& hint = "");

/// The same about a value that stands in a list.
[[noreturn]] void refuse_scene_value(const char* code,
                                     const MapReader& at,
                                     const Document& node,
                                     const std::string& path,
                                     const std::string& what,
                                     const std::string& hint = "");

/// A scalar: a name, a path, a number.
bool is_scalar(const Document& node);

/// Names go into logs, reports and terminals: no zero byte, a warning about what cannot be printed.
void check_scene_text(const MapReader& at,
                      const Document& node,
                      const std::string& path,
                      Scene& scene);

/// The word at `key`, one of `names`; else E0738 with the nearest of them.
std::size_t index_of_name(const MapReader& at,
                          std::string_view key,
                          const std::string& name,
                          const std::vector<std::string>& names,
                          const std::string& what);

/// From 1 to 1024.
void check_oversampling(const MapReader& at, std::uint64_t oversampling);

// ---- files ----

/// The path behind `key`, checked, and noted in `scene.files`.
std::string scene_file_of(const MapReader& at,
                          std::string_view key,
                          const SceneFolder& folder,
                          Scene& scene);

/// A path, or a map with a path and how to read the file.
std::string scene_recording_of(const MapReader& at,
                               std::string_view key,
                               const SceneFolder& folder,
                               ReadOptions& reading,
                               Scene& scene);

// ---- blocks ----

/// The block `simulate`, without sensors and faults.
ArraySimulation scene_simulation_of(const MapReader& top, const SceneFolder& folder, Scene& scene);

/// Where the sensors of a scene stand in its file, and which has which name.
struct SensorIndex {
  struct Place {
    const Document* node;
    std::string path;  ///< "sensors[3]"
  };
  std::vector<Place> places;  ///< of scene.sensors
  std::map<std::string, std::size_t> by_name;
};

/// The block `sensors`, into `scene.sensors`.
SensorIndex read_scene_sensors(const MapReader& top, const SceneFolder& folder, Scene& scene);

/// The sensor that `key` names.
std::size_t sensor_index(const MapReader& at,
                         std::string_view key,
                         const Scene& scene,
                         const SensorIndex& index);

/// The blocks `reference` and `tilt`, and whether every row h fits the true inputs.
void read_scene_reference(const MapReader& top,
                          const SceneFolder& folder,
                          const SensorIndex& index,
                          Scene& scene);

/// The blocks `learning`, `evaluation`, `rest`, `fault_free_s`, `faults` and `simulated`.
void read_scene_times(const MapReader& top, const SensorIndex& index, Scene& scene);

}  // namespace libchar

#pragma once
// The readers of a scene's parts, for scene_file.cpp alone.

#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/schema.hpp"
#include "libchar/scene/detail/scene_paths.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {

/// Throws Error(input): "WHERE: error CODE: KEY: WHAT".
[[noreturn]] void refuse_scene(const char* code,
                               const MapReader& at,
                               std::string_view key,
                               const std::string& what,
                               const std::string& hint = "");

/// A scalar: a name, a path, a number.
bool is_scalar(const Document& node);

/// The word at `key`, one of `names`; else E0738 with the nearest of them.
std::size_t index_of_name(const MapReader& at,
                          std::string_view key,
                          const std::string& name,
                          const std::vector<std::string>& names,
                          const std::string& what);

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

/// The block `simulate`, without sensors and faults.
ArraySimulation scene_simulation_of(const MapReader& top, const SceneFolder& folder, Scene& scene);

}  // namespace libchar

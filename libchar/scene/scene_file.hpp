#pragma once
// Reading a scene file.

#include <string>
#include <string_view>

#include "libchar/scene/scene.hpp"

namespace libchar {

struct SceneReadOptions {
  bool allow_outside = false;  ///< files outside the scene's folder may be named
};

/// Reads `format: scene`, `version: 1`, YAML or JSON (docs/scenes.md). Paths are relative to the
/// scene's folder and stay inside it. Throws Error(input) with place, key and the nearest valid
/// key.
Scene read_scene_file(const std::string& path, const SceneReadOptions& options = {});

/// Does this file say `format: scene`? Else it is something else that simulates, such as a model.
bool is_scene_file(const std::string& path);

/// The same from text that stands for a file at `path`.
Scene parse_scene(std::string_view text,
                  const std::string& path,
                  const SceneReadOptions& options = {});

}  // namespace libchar

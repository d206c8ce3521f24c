#pragma once
// Reading a scene file.

#include <string>
#include <string_view>

#include "libchar/scene/scene.hpp"

namespace libchar {

struct SceneReadOptions {
  bool allow_outside = false;  ///< files outside the scene's folder may be named
  /// The scene is to make its log again: the log may be gone, and logs of its true inputs are read.
  bool again = false;
};

/// Reads `format: scene`, `version: 1`, YAML or JSON (docs/scenes.md). Paths are relative to the
/// scene's folder and stay inside it. Throws Error(input) with place, key and the nearest valid
/// key.
Scene read_scene_file(const std::string& path, const SceneReadOptions& options = {});

/// Is this meant as a scene? By its suffix (.yaml, .yml, .json), or a line `format: scene` among
/// its first bytes. Else it is a log. Reads no more than 4 KiB; false for what cannot be opened.
bool looks_like_scene(const std::string& path);

/// Does this file say `format: scene`? Else it is something else that simulates, such as a model.
bool is_scene_file(const std::string& path);

/// The same from text that stands for a file at `path`.
Scene parse_scene(std::string_view text,
                  const std::string& path,
                  const SceneReadOptions& options = {});

}  // namespace libchar

#pragma once
// Files that a scene names: next to it or below it, regular, and only read.

#include <string>
#include <vector>

#include "libchar/scene/scene.hpp"

namespace libchar {

struct SceneFolder {
  std::string scene;           ///< path of the scene file
  bool allow_outside = false;  ///< files elsewhere may be named
  bool may_be_absent =
      false;  ///< a file that is not there yet is only checked for where it would be
};

/// The path of a file named in a scene under `key` ("reference.recording"). Throws Error(input) at
/// `where` ("FILE:LINE:COL") for a path that leaves the scene's folder (by "..", absolute, or over
/// a link), names the scene itself, or is not an existing regular file. Nothing is opened.
std::string resolve_scene_file(const std::string& named,
                               const SceneFolder& folder,
                               const std::string& where,
                               const std::string& key);

/// `file` relative to the folder of `scene`, as the scene would name it; absolute when it is
/// elsewhere. Throws Error(output) for a name that is not UTF-8, which YAML does not allow.
std::string path_for_scene(const std::string& file, const std::string& scene);

/// Throws Error(output) when an output would overwrite the scene or a file that it names, or two
/// outputs are one.
void refuse_scene_outputs(const Scene& scene, const std::vector<std::string>& outputs);

}  // namespace libchar

#pragma once
// A scene as YAML.

#include <string>

#include "libchar/core/document/json.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {

// The JSON Schema of a scene.

Json scene_schema();

/// The scene as YAML; paths relative to the folder of `scene.file`; models inline.
std::string scene_yaml(const Scene& scene);

}  // namespace libchar

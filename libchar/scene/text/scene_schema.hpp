#pragma once
// The JSON Schema of a scene.

#include "libchar/core/document/json.hpp"

namespace libchar {

Json scene_schema();

}  // namespace libchar

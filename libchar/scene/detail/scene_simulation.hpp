#pragma once
// The block `simulate` of a scene file.

#include "libchar/core/document/schema.hpp"
#include "libchar/scene/scene.hpp"
#include "libchar/scene/scene_paths.hpp"

namespace libchar {

/// The block `simulate`, without sensors and faults.
ArraySimulation scene_simulation_of(const MapReader& top, const SceneFolder& folder, Scene& scene);

}  // namespace libchar

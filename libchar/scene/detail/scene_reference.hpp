#pragma once
// The blocks `reference` and `tilt` of a scene file.

#include "libchar/scene/detail/scene_sensors.hpp"

namespace libchar {

/// The blocks `reference` and `tilt`, and whether every row h fits the true inputs.
void read_scene_reference(const MapReader& top,
                          const SceneFolder& folder,
                          const SensorIndex& index,
                          Scene& scene);

}  // namespace libchar

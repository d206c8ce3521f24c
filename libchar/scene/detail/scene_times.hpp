#pragma once
// The windows and faults of a scene file.

#include "libchar/scene/detail/scene_sensors.hpp"

namespace libchar {

/// The blocks `learning`, `evaluation`, `rest`, `fault_free_s`, `faults` and `simulated`.
void read_scene_times(const MapReader& top,
                      const SceneFolder& folder,
                      const SensorIndex& index,
                      Scene& scene);

}  // namespace libchar

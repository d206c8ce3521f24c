#pragma once
// The block `sensors` of a scene file.

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/schema.hpp"
#include "libchar/scene/scene.hpp"
#include "libchar/scene/scene_paths.hpp"

namespace libchar {

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

}  // namespace libchar

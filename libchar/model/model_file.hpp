#pragma once
#include <string>

#include "libchar/model/sensor_model.hpp"

namespace libchar {

/// The model as YAML (`format: sensor-model`, `version: 1`, docs/models.md): long keys, units, value
/// + interval + status per term, sidedness, provenance. Numbers read back to the same double in
/// YAML 1.1 and 1.2 readers.
std::string model_yaml(const SensorModel& model);

}  // namespace libchar

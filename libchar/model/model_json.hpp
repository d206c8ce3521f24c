#pragma once
// Sensor models as JSON: one model with the keys of its YAML file, several as a list.

#include <string>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/model/sensor_model.hpp"

namespace libchar {

/// `format: sensor-model`, `version: 1`: the keys of the model file; read_model_file reads it back
/// to the same doubles.
Json model_json(const SensorModel& model);

/// One model: model_json. Several: {"format":"sensor-models","version":1,"models":[…]}.
Json models_json(const std::vector<const SensorModel*>& models);

/// A file with one model (YAML or JSON) or with a list of models (JSON, as models_json writes it,
/// or the same in YAML). Throws Error(input).
std::vector<SensorModel> read_model_list(const std::string& path);

}  // namespace libchar

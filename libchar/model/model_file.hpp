#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/document.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/document/schema.hpp"
#include "libchar/model/sensor_model.hpp"

namespace libchar {

/// The model as YAML (`format: sensor-model`, `version: 1`, docs/models.md): long keys, units, value
/// + interval + status per term, sidedness, provenance. Numbers read back to the same double in
/// YAML 1.1 and 1.2 readers.
std::string model_yaml(const SensorModel& model);

// Sensor-model files: what a fit wrote, or what somebody wrote by hand from a data sheet.

/// Reads `format: sensor-model`, `version: 1`, YAML or JSON (docs/formats.md). Every value is
/// converted to the two-sided density and the channel's own unit; each conversion is said in
/// `remarks`. Throws Error(input) with place, key and the nearest valid key.
SensorModel parse_sensor_model(std::string_view text, const std::string& file);

/// The same from a file: at most 16 MiB, a regular file.
SensorModel read_model_file(const std::string& path);

/// The keys of a model inside another document (a scene): as a model file without format and
/// version, which are optional.
SensorModel sensor_model_of(const Document& node, const std::string& file, const std::string& path);

// Sensor models as JSON: one model with the keys of its YAML file, several as a list.

/// `format: sensor-model`, `version: 1`: the keys of the model file; read_model_file reads it back to the same doubles.
Json model_json(const SensorModel& model);

/// One model: model_json. Several: {"format":"sensor-models","version":1,"models":[…]}.
Json models_json(const std::vector<const SensorModel*>& models);

/// A file with one model (YAML or JSON) or with a list of models (JSON, as models_json writes it,
/// or the same in YAML). Throws Error(input).
std::vector<SensorModel> read_model_list(const std::string& path);

// The model files that a place holds: somebody who characterized a log has a folder and a report in his hand.

/// Of a folder of results, or its report.json, the model files in it, in the order of the channels; of a
/// folder of such folders, those of all; of any other file, itself. Throws Error(input) where a folder holds none.
std::vector<std::string> model_files(const std::string& path);

}  // namespace libchar

// Files of other programs that hold the noise of an inertial sensor: Kalibr's imu.yaml and what imu_utils writes.

namespace libchar::detail {

/// Whether a document holds sensor models, in the project's format or in one of those.
bool holds_models(const Document& document);

/// Models of a file of another program: one without an axis for three, or one for each axis; empty for any
/// other file. Throws Error(input).
std::vector<SensorModel> foreign_models(const Document& document, const std::string& file);

}  // namespace libchar::detail

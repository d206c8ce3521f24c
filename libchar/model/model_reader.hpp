#pragma once
// Sensor-model files: what a fit wrote, or what somebody wrote by hand from a data sheet.

#include <string>
#include <string_view>

#include "libchar/core/document/schema.hpp"
#include "libchar/model/sensor_model.hpp"

namespace libchar {

/// Reads `format: sensor-model`, `version: 1`, YAML or JSON (docs/formats.md). Every value is
/// converted to the two-sided density and the channel's own unit; each conversion is said in
/// `remarks`. Throws Error(input) with place, key and the nearest valid key.
SensorModel parse_sensor_model(std::string_view text, const std::string& file);

/// The same from a file: at most 16 MiB, a regular file.
SensorModel read_model_file(const std::string& path);

/// The keys of a model inside another document (a scene): as a model file without format and
/// version, which may stand there all the same.
SensorModel sensor_model_of(const Document& node, const std::string& file, const std::string& path);

}  // namespace libchar

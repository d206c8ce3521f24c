#pragma once
// Files of other programs that hold the noise of an inertial sensor: Kalibr's imu.yaml and what imu_utils writes.

#include <string>
#include <vector>

#include "libchar/core/document/document.hpp"
#include "libchar/model/sensor_model.hpp"

namespace libchar::detail {

/// Whether a document holds sensor models, in the project's format or in one of those.
bool holds_models(const Document& document);

/// Models of a file of another program: one without an axis for three, or one for each axis; empty for any
/// other file. Throws Error(input).
std::vector<SensorModel> foreign_models(const Document& document, const std::string& file);

}  // namespace libchar::detail

#pragma once
// The keys of a sensor-model file: what its reader, its YAML, its JSON and docs/models.md share.

#include "libchar/core/document/fields.hpp"
#include "libchar/model/sensor_model.hpp"

namespace libchar {

const Fields<SensorModel>& model_fields();

/// Everything that a file about `model` says, in its order.
std::vector<Entry> model_entries(const SensorModel& model);

}  // namespace libchar

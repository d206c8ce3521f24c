#pragma once
#include <string>

#include "libchar/core/text/text_table.hpp"
#include "libchar/model/sensor_model.hpp"

namespace libchar {

/// A sensor model in text, for a terminal: its terms with intervals, and the same in the units of
/// data sheets.
std::string model_text(const SensorModel& model, const TextLook& look = {});

}  // namespace libchar

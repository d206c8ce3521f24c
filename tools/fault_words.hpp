#pragma once
// A fault on the command line: SENSOR:KIND[=VALUE]@FROM..TO, times in seconds.

#include <string>
#include <vector>

#include "libchar/simulate/fault.hpp"

namespace sensorchar {

inline constexpr const char* kFaultHelp =
    "SENSOR:KIND[=VALUE]@FROM..TO in seconds; KIND scale, bias, ramp, stuck, saturation, noise, "
    "dropout";

/// `names`: the sensors, in order. Throws Error(usage) about --fault.
libchar::SensorFault fault_from_words(const std::string& text,
                                      const std::vector<std::string>& names);

}  // namespace sensorchar

#pragma once
// A fault in one line of text: SENSOR:KIND[=VALUE]@FROM..TO, times in seconds.

#include <string>
#include <vector>

#include "libchar/simulate/fault.hpp"

namespace libchar {

/// `names`: the sensors, in order. Throws Error(usage).
SensorFault parse_fault(const std::string& text, const std::vector<std::string>& names);

}  // namespace libchar

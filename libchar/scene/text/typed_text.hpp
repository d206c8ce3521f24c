#pragma once
// A fault in one line of text: SENSOR:KIND[=VALUE]@FROM..TO, times in seconds.

#include <string>
#include <vector>

#include "libchar/simulate/fault.hpp"
#include "libchar/simulate/signal.hpp"

namespace libchar {

// A true signal in one line of text: KIND,key=value,… with the keys that a scene has, or a number.

/// "sine,amplitude=2,frequency_hz=0.1"; a bare number is a constant. `place` is what errors say of
/// at the place of the text. Samples of kind recording are left unread (simulated_scene.hpp). Throws
/// Error(usage), and Error(input) for keys and values that a scene would refuse as well.
SignalSpec parse_signal(const std::string& text, const std::string& place);

/// `names`: the sensors, in order. Throws Error(usage).
SensorFault parse_fault(const std::string& text, const std::vector<std::string>& names);

}  // namespace libchar

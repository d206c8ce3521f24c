#pragma once
// Does a log hold a thermometer? Then its channels are read together: each is asked what it owes to it
// (detail/thermometers.cpp).

#include "libchar/log/recording.hpp"

namespace libchar::detail {

/// Is a channel of the log in a unit of temperature?
bool has_thermometer(const LogInfo& log);

}  // namespace libchar::detail

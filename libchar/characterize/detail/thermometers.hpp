#pragma once
// A log that holds its own explanation: channels whose slow part a temperature of the same log explains.

#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/log_thermometer.hpp"

namespace libchar::detail {

/// Of channels whose slow part is in doubt, with the thermometer of the log that explains most: a finding that names
/// it, and K is undetermined. By the channels' means, at 1 % a channel.
void ask_thermometers(std::vector<ChannelResult>& channels);

}  // namespace libchar::detail

#pragma once
// A replay in text, for a terminal.

#include <string>

#include "libchar/replay/replay.hpp"

namespace libchar {

/// The table of all algorithms that ran, best first, those that were skipped, and the verdict.
std::string replay_text(const ReplayResult& result);

/// Every algorithm there is: what it needs, and its options with units and defaults.
std::string algorithms_text();

}  // namespace libchar

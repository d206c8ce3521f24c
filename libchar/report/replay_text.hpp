#pragma once
// A replay for a terminal: ranking, what was skipped and why, verdict.

#include <string>

#include "libchar/replay/replay_view.hpp"

namespace libchar {

/// Control characters of names are escaped.
std::string replay_text(const ReplayView& view);

/// Every algorithm there is: what it needs, and its options with units and defaults.
std::string algorithms_text();

}  // namespace libchar

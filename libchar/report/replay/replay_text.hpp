#pragma once
// A replay for a terminal: ranking, what was skipped and why, verdict.

#include <string>

#include "libchar/replay/view/replay_view.hpp"

namespace libchar {

/// Control characters of names are escaped.
/// `width`: characters in a line that its table is fitted to; 0: any.
std::string replay_text(const ReplayView& view, std::size_t width = 0);

/// Every algorithm there is: what it needs, and its options with units and defaults.
std::string algorithms_text();

}  // namespace libchar

#pragma once
// A replay for a terminal: ranking, what was skipped and why, verdict.

#include <string>

#include "libchar/replay/replay_view.hpp"

namespace libchar {

/// Control characters of names are escaped.
std::string replay_text(const ReplayView& view);

}  // namespace libchar

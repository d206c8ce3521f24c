#pragma once
// report.html of a replay: one self-contained page.

#include <string>

#include "libchar/replay/replay_result.hpp"

namespace libchar {

std::string replay_html(const ReplayResult& result);

}  // namespace libchar

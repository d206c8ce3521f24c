#pragma once
// report.md of a replay: verdict and tables, for a pull request or a mail.

#include <string>

#include "libchar/replay/replay_result.hpp"

namespace libchar {

std::string replay_markdown(const ReplayResult& result);

}  // namespace libchar

#pragma once
// report.md of a replay: verdict and tables, for a pull request or a mail.

#include <string>
#include <string_view>

#include "libchar/replay/replay_result.hpp"

namespace libchar {

std::string replay_markdown(const ReplayResult& result);

/// Names and paths are anybody's: no mark of theirs becomes a tag, link, column or line.
std::string markdown_text(std::string_view text);

}  // namespace libchar

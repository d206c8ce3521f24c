#pragma once
// report.md of a replay: verdict and tables for a pull request.

#include <string>

#include "libchar/replay/replay_result.hpp"

namespace libchar {

std::string replay_markdown(const ReplayResult& result);

/// Untrusted text for a cell of a Markdown table: nothing in it is a tag, a link, a column or a
/// line.
std::string markdown_text(std::string_view text);

/// Rows of cells as a table; cells are taken as they are.
std::string markdown_table(const std::vector<std::string>& head,
                           const std::vector<std::vector<std::string>>& rows);

}  // namespace libchar

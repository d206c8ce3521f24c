#pragma once
// Tables for a terminal.

#include <string>
#include <string_view>
#include <vector>

namespace libchar {

/// Characters, not bytes: "°" takes one place on a terminal.
std::size_t width_of(std::string_view text);

/// Columns aligned by width in characters, the first (and the last, if it holds words) to the left
/// and the others to the right.
std::string text_table(const std::vector<std::vector<std::string>>& rows,
                       std::string_view indent = "  ",
                       bool words_last = false);

}  // namespace libchar

#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace libchar {

/// Columns aligned by width in characters, the first (and the last, if it holds words) to the left and the others to
/// the right. Where that is wider than `width` (0: any width), the words of the last column are wrapped; where that
/// does not do, the table is cut into one below the other, each beginning with the first column.
std::string text_table(const std::vector<std::vector<std::string>>& rows, std::string_view indent = "  ",
                       bool words_last = false, std::size_t width = 0);

/// Text, and a unit, as LaTeX has them: no package, no character beyond ASCII of those that units
/// and numbers here consist of.
std::string latex_text(const std::string& text);
std::string latex_unit(const std::string& unit);

}  // namespace libchar

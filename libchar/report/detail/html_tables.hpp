#pragma once
// Tables and lists of a page, their texts escaped.

#include <string>
#include <string_view>
#include <vector>

namespace libchar {

/// A table row of cells, each escaped as text; the first is a row header.
std::string table_row(const std::vector<std::string>& cells);
std::string table_head(const std::vector<std::string>& cells);
/// "<ul>…": nothing when there is no item.
std::string bullet_list(const std::vector<std::string>& items, std::string_view css_class);

}  // namespace libchar

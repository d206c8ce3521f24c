#include "libchar/fleet/detail/table_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "libchar/core/error.hpp"

namespace libchar {
namespace {

std::string trimmed(const std::string& cell) {
  const std::size_t first = cell.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return cell.substr(first, cell.find_last_not_of(" \t") - first + 1);
}

[[noreturn]] void refuse(const std::string& path, int line, const std::string& what) {
  throw Error({ErrorKind::input, "E0781", fmt::format("{}:{}:1", path, line), what, "", ""});
}

/// A cell that begins with a quotation mark ends with one, and has two for each of its own (RFC
/// 4180). No other character escapes: a path may hold backslashes.
std::vector<std::string> cells_of(const std::string& line,
                                  char separator,
                                  const std::string& path,
                                  int number) {
  std::vector<std::string> cells;
  std::string cell;
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool mark = line[i] == '"';
    if (quoted && mark && i + 1 < line.size() && line[i + 1] == '"')
      cell += line[i++];
    else if (quoted && mark)
      quoted = false;
    else if (!quoted && mark && trimmed(cell).empty())
      quoted = true;
    else if (!quoted && line[i] == separator)
      cells.push_back(trimmed(std::exchange(cell, "")));
    else
      cell += line[i];
  }
  if (quoted) refuse(path, number, "a quotation mark is not closed in its line");
  cells.push_back(trimmed(cell));
  return cells;
}

char separator_of(const std::string& head) {
  for (const char separator : {',', ';', '\t'})
    if (head.find(separator) != std::string::npos) return separator;
  return ',';
}

}  // namespace

TableText parse_table_text(std::string_view text, const std::string& path, std::size_t most_rows) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  TableText table;
  char separator = ',';
  int number = 0;
  while (!text.empty() && (table.heads.empty() || table.rows.size() < most_rows)) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string line(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    if (line.ends_with('\r')) line.pop_back();
    if (line.find_first_not_of(" \t,;") == std::string::npos || line[0] == '#') continue;
    if (table.heads.empty()) separator = separator_of(line);
    std::vector<std::string> cells = cells_of(line, separator, path, number);
    if (table.heads.empty()) {
      table.heads = std::move(cells);
      table.head_line = number;
      continue;
    }
    if (cells.size() != table.heads.size())
      refuse(
          path, number, fmt::format("{} cells under {} heads", cells.size(), table.heads.size()));
    table.rows.push_back({number, std::move(cells)});
  }
  return table;
}

}  // namespace libchar

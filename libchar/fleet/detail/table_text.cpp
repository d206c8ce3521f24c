#include "libchar/fleet/detail/table_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/tokenizer.hpp>

#include "libchar/core/error.hpp"

namespace libchar {
namespace {

using Separator = boost::escaped_list_separator<char>;

std::string trimmed(const std::string& cell) {
  const std::size_t first = cell.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return cell.substr(first, cell.find_last_not_of(" \t") - first + 1);
}

[[noreturn]] void refuse(const std::string& path, int line, const std::string& what) {
  throw Error({ErrorKind::input, "E0781", fmt::format("{}:{}:1", path, line), what, "", ""});
}

std::vector<std::string> cells_of(const std::string& line,
                                  char separator,
                                  const std::string& path,
                                  int number) {
  if (std::count(line.begin(), line.end(), '"') % 2 != 0)
    refuse(path, number, "a quotation mark is not closed in its line");
  std::vector<std::string> cells;
  // No escape character: a path may hold backslashes.
  for (const std::string& cell :
       boost::tokenizer<Separator>(line, Separator("", std::string(1, separator), "\"")))
    cells.push_back(trimmed(cell));
  return cells;
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
    if (table.heads.empty() && line.find(',') == std::string::npos &&
        line.find(';') != std::string::npos)
      separator = ';';
    std::vector<std::string> cells = cells_of(line, separator, path, number);
    if (table.heads.empty()) {
      table.heads = std::move(cells);
      for (const std::string& head : table.heads)
        if (std::count(table.heads.begin(), table.heads.end(), head) > 1)
          refuse(path, number, fmt::format("the column {} stands twice", head));
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

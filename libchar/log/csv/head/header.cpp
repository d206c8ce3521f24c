#include "libchar/log/csv/head/header.hpp"

#include <fmt/format.h>

#include <map>

#include "libchar/core/text/text.hpp"

namespace libchar::csv {

std::string place_name(std::uint64_t line, std::uint64_t column) {
  return column <= 1 ? fmt::format("line {}", line)
                     : fmt::format("line {}, column {}", line, column);
}

void name_columns(Dialect& dialect, LogInfo& info) {
  std::map<std::string, int> stripped;
  for (Column& column : dialect.columns) {
    std::tie(column.name, column.unit) = name_and_unit(column.text);
    if (column.unit.empty()) column.unit = column.unit_below;
    ++stripped[column.name];
  }
  std::map<std::string, const Column*> seen;
  for (std::size_t i = 0; i < dialect.columns.size(); ++i) {
    Column& column = dialect.columns[i];
    if (!dialect.has_header) continue;
    if (column.name.empty()) {
      column.name = fmt::format("c{}", i);
      column.unnamed = true;
    } else if (stripped[column.name] > 1) {
      column.name =
          std::string(trimmed(column.text));  // acc_g beside acc_mg: the full texts differ
    }
    if (std::string_view("=+-@\t\r").find(column.name[0]) != std::string_view::npos)
      info.warnings.add("formula_name",
                        "channel names that a spreadsheet would run as a formula: kept, and "
                        "prefixed with ' in CSV that is written",
                        place_name(column.line, column.position));
    if (printable(column.name).find("\\u{") != std::string::npos ||
        printable(column.name).find("\\x") != std::string::npos)
      info.warnings.add(
          "control_in_name",
          "channel names with invisible or direction-changing characters: shown escaped",
          place_name(column.line, column.position));
    const auto [other, fresh] = seen.emplace(column.name, &column);
    if (!fresh)
      throw Error({ErrorKind::input,
                   "E0307",
                   fmt::format("{}:{}:{}", info.file, column.line, column.position),
                   fmt::format("two columns have the same name (first at {}:{})",
                               other->second->line,
                               other->second->position),
                   column.name,
                   "rename one, or read with `header` no and `skip_rows` 1 to use positions"});
  }
}

}  // namespace libchar::csv

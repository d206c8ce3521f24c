#include "libchar/log/csv/header.hpp"

#include <fmt/format.h>

#include <map>

#include "libchar/core/decimal.hpp"
#include "libchar/core/text.hpp"
#include "libchar/log/csv/number.hpp"
#include "libchar/log/reading_fields.hpp"

namespace libchar::csv {

std::string place_name(std::uint64_t line, std::uint64_t column) {
  return column <= 1 ? fmt::format("line {}", line)
                     : fmt::format("line {}, column {}", line, column);
}

void name_columns(Dialect& dialect, LogInfo& info) {
  std::map<std::string, int> stripped;
  for (Column& column : dialect.columns) {
    std::tie(column.name, column.unit) = name_and_unit(column.text);
    ++stripped[column.name];
  }
  std::map<std::string, const Column*> seen;
  for (std::size_t i = 0; i < dialect.columns.size(); ++i) {
    Column& column = dialect.columns[i];
    if (!dialect.has_header) continue;
    if (column.name.empty()) {
      column.name = fmt::format("c{}", i);
      info.warnings.add("unnamed_column",
                        "columns without a name are named by their position, c0, c1…",
                        place_name(column.line, column.position));
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

void read_rate_comment(std::string_view comment, LogInfo& info) {
  const std::string text = ascii_lower(comment);
  const std::size_t word = text.find("rate");
  const std::size_t hz = text.find("hz", word == std::string::npos ? 0 : word);
  if (word == std::string::npos || hz == std::string::npos) return;
  std::string number = text.substr(word + 4, hz - word - 4);
  number.erase(0, number.find_first_of("0123456789"));
  const double factor = !number.empty() && number.back() == 'k' ? 1000 : 1;
  number.erase(number.find_last_of("0123456789.") + 1);
  const auto rate = parse_double(number);
  if (!rate || *rate * factor < kRates.lowest || *rate * factor > kRates.highest) return;
  info.time.rate_hz = *rate * factor;
  info.dialect.push_back(fmt::format("rate {} Hz from a comment", shortest(info.time.rate_hz)));
}

}  // namespace libchar::csv

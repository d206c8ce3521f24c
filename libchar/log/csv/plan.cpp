#include "libchar/log/csv/plan.hpp"

#include <fmt/format.h>

#include "libchar/core/error.hpp"
#include "libchar/log/time/column_choice.hpp"

namespace libchar::csv {
namespace {

// By name, by the text of its header, or by its position c0, c1… among the columns that are not the
// time.
std::size_t find_channel(const std::string& wanted,
                         const std::vector<std::string>& names,
                         const std::vector<std::size_t>& columns,
                         const Dialect& dialect,
                         const ReadOptions& options,
                         const std::string& file) {
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k] == wanted) return k;
  for (std::size_t k = 0; k < names.size(); ++k)
    if (dialect.columns[columns[k]].text == wanted) return k;
  if (wanted.size() > 1 && wanted.size() < 8 && wanted[0] == 'c' &&
      wanted.find_first_not_of("0123456789", 1) == std::string::npos) {
    const auto k = static_cast<std::size_t>(std::stoul(wanted.substr(1)));
    if (k < names.size()) return k;
  }
  if (dialect.time_column >= 0 &&
      dialect.columns[static_cast<std::size_t>(dialect.time_column)].name == wanted)
    throw Error({ErrorKind::usage,
                 "E0320",
                 file,
                 "this is the time column, not a channel",
                 wanted,
                 "--time-column none reads it as a channel"});
  throw Error({ErrorKind::usage,
               "E0320",
               file,
               "there is no channel of this name",
               wanted,
               channel_hint(wanted, names, options)});
}

}  // namespace

Plan plan_columns(Dialect& dialect, const ReadOptions& options, LogInfo& info) {
  Plan plan;
  std::vector<std::size_t> value_columns;
  for (std::size_t i = 0; i < dialect.columns.size(); ++i)
    if (static_cast<int>(i) != dialect.time_column) value_columns.push_back(i);
  if (value_columns.empty())
    throw Error({ErrorKind::input,
                 "E0310",
                 info.file,
                 "there is a time column and nothing else",
                 "",
                 "--time-column none reads it as a channel"});
  std::vector<std::string> names;
  for (std::size_t k = 0; k < value_columns.size(); ++k) {
    Column& column = dialect.columns[value_columns[k]];
    if (column.name.empty()) column.name = fmt::format("c{}", k);
    names.push_back(column.name);
  }
  std::vector<bool> wanted(value_columns.size(), options.channels.empty());
  for (const std::string& name : options.channels)
    wanted[find_channel(name, names, value_columns, dialect, options, info.file)] = true;
  plan.dialect = &dialect;
  plan.overflow_as_missing = options.overflow_as_missing;
  plan.skip_repeated_header = options.skip_repeated_header;
  plan.target.assign(dialect.columns.size(), Plan::kSkip);
  if (dialect.time_column >= 0)
    plan.target[static_cast<std::size_t>(dialect.time_column)] = Plan::kTime;
  for (std::size_t k = 0; k < value_columns.size(); ++k) {
    if (!wanted[k]) continue;
    const Column& column = dialect.columns[value_columns[k]];
    plan.target[value_columns[k]] = static_cast<int>(plan.channels++);
    info.channels.push_back({column.name, column.unit, true});
  }
  return plan;
}

}  // namespace libchar::csv

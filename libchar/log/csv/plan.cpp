#include "libchar/log/csv/plan.hpp"

#include <fmt/format.h>

#include "libchar/log/detail/channel_choice.hpp"

namespace libchar::csv {
Plan plan_columns(Dialect& dialect, const ReadOptions& options, LogInfo& info) {
  Plan plan;
  TableColumns table;
  table.positions_skip_time = true;
  if (dialect.time_column >= 0) table.time = static_cast<std::size_t>(dialect.time_column);
  std::size_t values = 0;
  for (std::size_t i = 0; i < dialect.columns.size(); ++i) {
    Column& column = dialect.columns[i];
    if (column.name.empty() && i != table.time) column.name = fmt::format("c{}", values);
    values += i != table.time;
    table.names.push_back(column.name);
    table.texts.push_back(column.text);
  }
  plan.dialect = &dialect;
  plan.overflow_as_missing = options.overflow_as_missing;
  plan.skip_repeated_header = options.skip_repeated_header;
  plan.target.assign(dialect.columns.size(), Plan::kSkip);
  if (dialect.time_column >= 0)
    plan.target[static_cast<std::size_t>(dialect.time_column)] = Plan::kTime;
  for (const std::size_t i : choose_channels(table, options, info.file)) {
    const Column& column = dialect.columns[i];
    plan.target[i] = static_cast<int>(plan.channels++);
    info.channels.push_back({column.name, column.unit, true});
  }
  return plan;
}

}  // namespace libchar::csv

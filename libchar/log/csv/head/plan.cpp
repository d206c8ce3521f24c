#include "libchar/log/csv/head/plan.hpp"

#include <fmt/format.h>

#include "libchar/log/detail/channel_choice.hpp"

namespace libchar::csv {
Plan plan_columns(Dialect& dialect, const ReadOptions& options, LogInfo& info) {
  Plan plan;
  TableColumns table;
  table.positions_skip_time = true;
  if (dialect.time.column >= 0) table.time = static_cast<std::size_t>(dialect.time.column);
  if (dialect.more_time.column >= 0) table.more_time = static_cast<std::size_t>(dialect.more_time.column);
  std::size_t values = 0;
  for (std::size_t i = 0; i < dialect.columns.size(); ++i) {
    Column& column = dialect.columns[i];
    const bool value = i != table.time && i != table.more_time;
    if (column.name.empty() && value) column.name = fmt::format("c{}", values);
    values += value ? 1 : 0;
    if (column.left_out) table.left_out.push_back(i);
    table.names.push_back(column.name);
    table.texts.push_back(column.text);
  }
  plan.dialect = &dialect;
  plan.overflow_as_missing = options.missing.overflow;
  plan.drop_bad_rows = options.missing.bad_rows;
  plan.several_clocks = std::any_of(dialect.columns.begin(), dialect.columns.end(),
                                    [](const Column& one) { return !one.own_clock.empty(); });
  plan.skip_repeated_header = options.skip_repeated_header;
  plan.target.assign(dialect.columns.size(), Plan::kSkip);
  if (table.time) plan.target[*table.time] = Plan::kTime;
  if (table.more_time) plan.target[*table.more_time] = Plan::kMoreTime;
  for (const std::size_t i : choose_channels(table, options, info.file)) {
    const Column& column = dialect.columns[i];
    plan.target[i] = static_cast<int>(plan.channels++);
    info.channels.push_back({column.name, column.unit, true});
    info.channels.back().own_clock = column.own_clock;
  }
  return plan;
}

}  // namespace libchar::csv

#pragma once
// Which column of a table is the time, and in which unit.

#include <vector>

#include "libchar/log/csv/dialect.hpp"

namespace libchar::csv {

/// Finds the time column and its unit; `rows` are the first data rows.
void choose_time(Dialect& dialect,
                 const std::vector<std::vector<Field>>& rows,
                 const ReadOptions& options,
                 LogInfo& info);

}  // namespace libchar::csv

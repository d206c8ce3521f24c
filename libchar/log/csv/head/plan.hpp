#pragma once
// Which columns of a CSV file are read, and as what.

#include "libchar/log/csv/head/dialect.hpp"
#include "libchar/log/csv/rows/rows.hpp"

namespace libchar::csv {

/// The channels to read, in file order, into info.channels, and what to do with each column. Names the columns that
/// have no name. The plan points at `dialect`. Throws Error(usage) for a channel that is not there.
Plan plan_columns(Dialect& dialect, const ReadOptions& options, LogInfo& info);

}  // namespace libchar::csv

#pragma once
// What the cells and comments around a header line mean.

#include <string>

#include "libchar/log/csv/head/dialect.hpp"

namespace libchar::csv {

/// Fills names and units of dialect.columns from their header texts; duplicates are an error,
/// strange names a warning.
void name_columns(Dialect& dialect, LogInfo& info);

/// "line 412", "line 412, column 6": a place in the form Findings use.
std::string place_name(std::uint64_t line, std::uint64_t column);

}  // namespace libchar::csv

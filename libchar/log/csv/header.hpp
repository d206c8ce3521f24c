#pragma once
// Names and units: what the cells of a header line mean.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libchar/log/csv/dialect.hpp"

namespace libchar::csv {

/// "gyro_x [deg/s]", "Time (s)", "t_ns" → name and unit; a suffix behind '_' counts only when it is
/// a known unit.
std::pair<std::string, std::string> name_and_unit(std::string_view header_cell);

/// Fills names and units of dialect.columns from their header texts; duplicates are an error,
/// strange names a warning.
void name_columns(Dialect& dialect, LogInfo& info);

/// "// Update Rate: 100.0Hz": a comment that states the sampling rate.
void read_rate_comment(std::string_view comment, LogInfo& info);

std::string latin1_to_utf8(std::string_view text);

/// "line 412", "line 412, column 6": a place in the form Warnings use.
std::string place_name(std::uint64_t line, std::uint64_t column);

}  // namespace libchar::csv

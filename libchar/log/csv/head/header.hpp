#pragma once
// Names and units of the columns of a CSV file: by a line of names and one of units, by the comment
// in front of the rows, by what stands in the cells.

#include <optional>
#include <string>

#include "libchar/log/csv/head/study.hpp"

namespace libchar::csv {

/// The columns by a line of names, `text` of it behind a sign of comments.
void read_names(Study& study, const Line& line, std::string_view text);

/// Units below them.
void read_units(Study& study, const Line& line);

/// The columns of a table whose first row is `sample[0]` and has no line of names: by the last
/// comment before it, by labels in front of the values, or none.
void do_without_names(Study& study);

/// The columns and the begin of a log of chrony or ntpd, by its first rows.
bool named_by_daemon(Study& study);

/// Settings beside the names of oscilloscopes are none.
void take_scope_settings(Study& study);

/// Nor are two lines in front of the names that state what follows and its rate, as Nexus writes them.
void take_rate_of_nexus(Study& study);

/// The begin of a log whose first row is the time, and whose second is the rate.
bool begins_with_rate(Study& study);

/// Names and rate between lines that say what stands below them, as SignalExpress writes them.
bool named_by_signal_express(Study& study);

/// Keys in front of the lines, nothing in front of the rows: recorders of Yokogawa.
bool named_by_yokogawa(Study& study);

/// Units behind the numbers of the rows ("0.005 sec"), and of counts whose scale the preamble states.
void find_other_units(Study& study);

/// Fills names and units of dialect.columns from their header texts; duplicates are an error, strange names a warning.
void name_columns(Dialect& dialect, LogInfo& info);

/// "line 412", "line 412, column 6": a place in the form Findings use.
std::string place_name(std::uint64_t line, std::uint64_t column);

}  // namespace libchar::csv

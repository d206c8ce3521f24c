#pragma once
// What kind of CSV a file is, found out from its first bytes: delimiter, decimal mark, header,
// names and units, time column.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/error.hpp"
#include "libchar/log/csv/line.hpp"
#include "libchar/log/detail/row_source.hpp"
#include "libchar/log/read.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/log/time/calendar.hpp"

namespace libchar::csv {

inline constexpr std::size_t kMaxLine = std::size_t{1} << 20U;  // 1 MiB
inline constexpr std::size_t kMaxName = 1024;
inline constexpr std::size_t kMaxColumns = detail::kMostChannels + 1;  // and the stamps
inline constexpr std::size_t kHeadBytes = 2 * kMaxLine;  // sniffed; holds at least one line of the longest kind

struct Column {
  std::string name, unit;
  std::string unit_below;  ///< in a second header line
  std::string own_clock;   ///< column with the stamps of its values, where they are not those of the log
  std::string cell_unit;   ///< behind every number, as in the file: "sec" of "0.005 sec"
  bool elapsed = false;    ///< times whose units change, as Go prints them: "980ms", "1s", "1m0.5s"
  bool unnamed = false;    ///< the header has an empty cell
  bool words = false;      ///< known to hold words, whatever they look like
  bool clock = false;      ///< the stamps once more, from another zero or in another unit
  bool left_out = false;   ///< words, or a count of the rows: no channel unless it is asked for
  std::string text;        ///< header cell as written
  std::uint64_t line = 0;  ///< place of the header cell, 1-based; 0 without header
  std::uint64_t position = 0;
};

/// How a column of stamps is written.
struct StampPart {
  int column = -1;           ///< index among all columns, -1 = none
  bool calendar = false;     ///< dates or clock times, else numbers
  std::int64_t unit_ns = 1;  ///< of numbers
  double zero = 0;           ///< in that unit: days that begin long before 1970
  /// what the digits behind the mark count, where they are written without leading zeros ("12.5" is
  /// 12 s and 5 ns); 0 = a fraction
  std::int64_t fraction_ns = 0;
  bool of_hour = false;  ///< "12:05" is 12 minutes and 5 seconds
  bool elapsed = false;  ///< "1m2.5s"
  bool digits = false;   ///< 125959.5 is 12:59:59.5, 20240501125959 has its date too
};

/// Rows with another value in this column are left out, or (`must`) refused.
struct RowFilter {
  int column = -1;
  std::string value;
  bool must = false;
};

/// What lines may hold beside cells.
struct LineForm {
  bool quotes = false;              ///< cells of the head stand in them, and may hold line ends
  bool semicolon_comments = false;  ///< ';' begins one, as '#' does
  bool trailing_delimiter = false;  ///< lines end with a delimiter and nothing behind it
  bool few_names = false;           ///< fewer than the rows have cells
};

struct Dialect {
  char delimiter = ',';  ///< ' ' stands for runs of blanks and tabs
  char decimal = '.';
  char thousands = 0;  ///< between groups of three digits; 0 = none
  std::string lead;    ///< what ends a stamp in front of the cells (lead_of); "" = none
  LineEnd line_end = LineEnd::lf;
  LineForm lines;
  bool has_header = false;
  std::string header;  ///< the header line as it stands in the file, to recognise a repeated one
  std::vector<Column> columns;
  StampPart time;
  StampPart more_time;  ///< added to it: a clock time to its date, nanoseconds to their seconds
  DateOrder date_order = DateOrder::day_first;
  std::vector<RowFilter> filters;
  int group_column = -1;              ///< its values make channels of their own
  std::vector<std::string> groups;    ///< these, in the order of the file
  bool sorted = false;                ///< all rows of one group come before those of the next
  bool cycles = false;                ///< each group once, in turn: a turn is a row, at its first stamp
  std::int64_t clock_period_ns = 0;   ///< stamps begin again at midnight, or every hour; 0 = never
  std::size_t data_offset = 0;        ///< byte at which the first line after the header starts
  std::uint64_t first_data_line = 1;  ///< its physical line number
};

/// Studies `head` (all of the file when `whole`) and fills channels, guesses, dialect, warnings and what is known of
/// the time base into `info`. Throws Error with a place when the head cannot be a log.
Dialect understand(std::string_view head, bool whole, const ReadOptions& options, LogInfo& info);

}  // namespace libchar::csv

#pragma once
// Where in the first lines of a file its table begins: what stands in front, the line of names, the
// line of units, the rows.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/log/csv/head/columns.hpp"

namespace libchar::csv {

// What the lines around a table say of its sampling.

/// "// Update Rate: 100.0Hz", "OutputRate:,60Hz", "Sample Rate;1000", "Sample Interval,1.6e-09", "Delta_X<tab>0.001":
/// the sampling rate in Hz that a line states; nothing when it states none that can be.
std::optional<double> stated_rate_hz(std::string_view line);

/// Does a line in front of the table hold a number and a word for time or rate?
bool speaks_of_time(std::string_view line);

/// What one count is: "tscale,0.001" (s), "gscale,0.00122" (rad/s) and "ascale,0.00049" (g) of Gyroflow's .gcsv.
std::optional<double> stated_count(std::string_view line, std::string_view key);

struct TableStart {
  std::size_t data = 0;              ///< index of the first row of numbers
  std::optional<std::size_t> names;  ///< of the line of names
  std::optional<std::size_t> units;  ///< of a line of units below it
};

/// `lines` are the cells of the first lines, an empty cell behind a delimiter at the end of a line
/// taken off; `kinds` what the columns hold further down.
TableStart find_table_start(const std::vector<Cells>& lines, const std::vector<ColumnKind>& kinds, NumberStyle style);

}  // namespace libchar::csv

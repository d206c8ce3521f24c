#pragma once
// Which column of a table is the time, and in which unit: one rule for all formats. A name says time ("t", "elapsed",
// "time_us"), a unit stands in brackets, behind '_' or apart; what neither says is guessed from the size and the step
// of the first stamps, and every guess is put down as one.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/log/read.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

// Which names of columns say time, in what unit, and whose clock it is.

/// Whose clock a column is: a device stamps its samples when it takes them, a host when they arrive.
enum class Clock : std::uint8_t { device, unknown, host };

struct TimeName {
  std::int64_t unit_ns = 0;  ///< 0 = not said by the name
  Clock clock = Clock::unknown;
  bool letter = false;  ///< "t" alone, which is a temperature or a torque elsewhere
  bool date = false;    ///< a word for dates and clocks: time only where the values are such
};

/// What the name of a column, without its unit, says of time; nothing when it says something else.
/// In capitals or not, in the languages that spreadsheets speak.
std::optional<TimeName> time_name(std::string_view stem);

struct ColumnLabel {
  std::string name;           ///< as it stands in the file, "" when the file names no columns
  std::string unit;           ///< said apart from the name (by a sidecar); "" when it can only be in the name
  std::string numbered = {};  ///< with the number that is put behind the second of a name
  bool calendar = false;      ///< its values are dates or clock times, `first_values` seconds
  bool text = false;          ///< no numbers, or part of the stamps of another column: never the time
};

/// The first finite values of a column.
struct FirstValues {
  std::vector<double> values;
  bool integers = true;  ///< all of them stored as integers
};

inline constexpr std::size_t kFirstRows = 100;  ///< that the rule looks at

/// What the rule looks at.
struct TableFront {
  std::vector<ColumnLabel> columns;
  bool named = false;  ///< the names come from the file, and one of them may say time
  bool text = false;   ///< a text table without names has its stamps in front, as a rule; an array is all channels
  std::function<FirstValues(std::size_t column)> first_values;
  std::optional<double> stated_rate_hz;  ///< by a comment or a preamble of the file
  std::optional<double> stated_tick_s;   ///< the same of one count of the stamps
};

/// Does a column of this name hold stamps ("t", "time_us", "Time (s)")?
bool called_time(const std::string& name);

/// The column that options.time_column names (by name or position c0, c1… among all columns), or that says time by its
/// name, its unit or its dates or, without names, by how it rises. Of several those that rise, a device's clock before
/// others, the steadier before others; the choice is a guess that names them all. Nothing when there is none. Throws
/// Error(usage) for a name that is not there.
std::optional<std::size_t> find_time_column(const TableFront& table, const ReadOptions& options, LogInfo& info);

/// A unit of time that stands behind the name, in ns: "[ms]", "(in Stunden)", "_min"; else 0.
std::int64_t unit_behind(const ColumnLabel& column);

/// The unit of stamps in ns, as the file or the name says, one behind the name before the usual one of the name
/// ("TOW [ms]"); 0 where neither does.
std::int64_t unit_said(const ColumnLabel& column);

/// "frame", "Packet number", "sample_no": counts what was taken, and is no clock however steadily it rises.
bool called_count(std::string_view name);

/// Whole numbers that follow a finer clock from count to count ("seconds" beside milliseconds): the same clock.
bool keeps_time(const TableFront& table, std::size_t coarse, std::size_t fine);

/// Columns of stamps beside the chosen one that step at another rate, channels behind them: tables of several loggers
/// side by side.
std::vector<std::size_t> clocks_of_others(const TableFront& table, std::size_t chosen);

/// "X_Value_2" beside "X_Value": columns of stamps of a .lvm, which part somewhere.
bool clock_of_labview(const std::string& column, const std::string& chosen);

/// "Tiempo1" and "Tiempo2", or one name twice.
bool numbered_alike(const std::string& a, const std::string& b);

/// The usual distance of two values, 0 for fewer.
double usual_step(const std::vector<double>& values);

/// How numbers become nanoseconds: (number - zero) * ns.
struct StampUnit {
  std::int64_t ns = 0;
  double zero = 0;  ///< 1970 in a count of days that begins long before it
};

/// The unit of that column; its name and whether it is a guess go to
/// info.time. A guess has to agree with a rate that the file states (Error(input) else, with both),
/// a unit that is said gives a warning. Throws Error(usage) for an unknown options.time_unit.
StampUnit find_time_unit(const TableFront& table, std::size_t column, const ReadOptions& options, LogInfo& info);

}  // namespace libchar

#include "libchar/log/time/time_column.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/median.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/detail/channel_choice.hpp"
#include "libchar/log/detail/column_name.hpp"

namespace libchar {
namespace {

struct TimeName {
  std::string_view name;
  std::int64_t unit_ns;  // 0 = not said by the name
};

constexpr std::array kTimeNames = {
    TimeName{"t", 0},
    TimeName{"time", 0},
    TimeName{"timestamp", 0},
    TimeName{"time stamp", 0},
    TimeName{"timestamps", 0},
    TimeName{"stamp", 0},
    TimeName{"times", 0},
    TimeName{"elapsed", 0},
    TimeName{"elapsed time", 0},
    TimeName{"elapsed_time", 0},
    TimeName{"time_stamp", 0},
    TimeName{"host_time", 0},
    TimeName{"sample_time", 0},
    TimeName{"sampletime", 0},
    TimeName{"timeus", 1000},
    TimeName{"timems", 1000000},
    TimeName{"seconds", 1000000000},
    TimeName{"sec", 1000000000},
    TimeName{"secs", 1000000000},
    TimeName{"millis", 1000000},
    TimeName{"milliseconds", 1000000},
    TimeName{"micros", 1000},
    TimeName{"microseconds", 1000},
    TimeName{"nanoseconds", 1},
    TimeName{"sampletimefine", 100000}};  // Xsens SampleTimeFine counts 0.1 ms

// Whose clock it is: a device stamps its samples when it takes them, a host when they arrive.
constexpr std::array<std::string_view, 7> kDevices = {
    "device", "dev", "sensor", "imu", "hardware", "hw", "sample"};
constexpr std::array<std::string_view, 11> kHosts = {
    "host", "pc", "ros", "system", "sys", "recv", "receive", "received", "arrival", "log", "unix"};
constexpr std::array<std::string_view, 3> kTimes = {"time", "timestamp", "stamp"};

// "imu_time", "time_host" or "arrival timestamp": one of `words` beside a word for time.
template <std::size_t N>
bool time_of(const std::string& name, const std::array<std::string_view, N>& words) {
  const std::size_t between = name.find_first_of("_ .-");
  if (between == std::string::npos) return false;
  const std::string_view all(name), first = all.substr(0, between),
                                    second = all.substr(between + 1);
  const auto among = [](const auto& list, std::string_view word) {
    return std::find(list.begin(), list.end(), word) != list.end();
  };
  return (among(words, first) && among(kTimes, second)) ||
         (among(kTimes, first) && among(words, second));
}

enum class Clock { device, unknown, host };

Clock clock_of(std::string_view stem) {
  const std::string name = ascii_lower(stem);
  if (name == "sampletimefine" || name == "sampletime" || time_of(name, kDevices))
    return Clock::device;
  return time_of(name, kHosts) ? Clock::host : Clock::unknown;
}

const TimeName* find_time_name(std::string_view stem) {
  const std::string wanted = ascii_lower(stem);
  for (const TimeName& known : kTimeNames)
    if (known.name == wanted) return &known;
  static constexpr TimeName other{"timestamp_", 0};
  const bool said = wanted.starts_with("timestamp_") || wanted.starts_with("timestamp ") ||
                    clock_of(stem) != Clock::unknown;
  return said ? &other : nullptr;
}

std::int64_t unit_in_ns(std::string_view unit) {
  const auto known = find_unit(unit);
  if (!known || known->quantity != Quantity::time) return 0;
  return std::llround(known->to_si * 1e9);
}

std::string unit_name(std::int64_t ns) {
  switch (ns) {
    case 1:
      return "ns";
    case 1000:
      return "us";
    case 1000000:
      return "ms";
    case 1000000000:
      return "s";
    case 60000000000:
      return "min";
    case 3600000000000:
      return "h";
    default:
      return fmt::format("{} ns", ns);
  }
}

double median_step(const std::vector<double>& values) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
  if (steps.empty()) return 0;
  return median_in_place(steps, Middle::lower);
}

bool near_uniform_and_rising(const std::vector<double>& values) {
  if (values.size() < 3) return false;
  const double step = median_step(values);
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double d = values[i] - values[i - 1];
    if (!(d > 0) || d > 10 * step) return false;
  }
  return step > 0;
}

// Time since 1970 betrays its unit by its size; a time since power-on by its step, as sensors run at 0.5 Hz to 50 kHz.
std::int64_t guess_unit(const FirstValues& first) {
  const std::vector<double>& values = first.values;
  const double size = values.empty() ? 0 : std::fabs(values[0]);
  if (size >= 1e17) return 1;
  if (size >= 1e14) return 1000;
  if (size >= 1e11 && size < 1e14) return 1000000;
  if (size >= 1e9 && size < 1e10 && !first.integers) return 1000000000;
  const double step = median_step(values);
  if (step < 2) return 1000000000;
  if (step < 200) return 1000000;
  if (step < 200000) return 1000;
  return 1;
}

// The name of a column without its unit.
std::string stem_of(const ColumnLabel& column) {
  return name_and_unit(column.name).first;
}

std::size_t named_column(const TableFront& table,
                         const std::string& wanted,
                         const ReadOptions& options,
                         const std::string& file) {
  const auto& columns = table.columns;
  const auto same = [&](const ColumnLabel& c) { return c.name == wanted; };
  const auto same_stem = [&](const ColumnLabel& c) { return stem_of(c) == wanted; };
  const auto found = std::find_if(columns.begin(), columns.end(), same);
  if (found != columns.end()) return static_cast<std::size_t>(found - columns.begin());
  if (std::count_if(columns.begin(), columns.end(), same_stem) == 1)
    return static_cast<std::size_t>(std::find_if(columns.begin(), columns.end(), same_stem) -
                                    columns.begin());
  if (const auto index = position_in(wanted, columns.size())) return *index;
  std::vector<std::string> names;
  names.reserve(columns.size());
  for (const ColumnLabel& column : columns)
    names.push_back(column.name.empty() ? fmt::format("c{}", names.size()) : column.name);
  throw Error({ErrorKind::usage,
               "E0320",
               file,
               "there is no column of this name for the time",
               wanted,
               channel_hint(wanted, names, options)});
}

// The first that is a device's time, else the first that is not said to be a host's, else the first.
std::optional<std::size_t> column_called_time(const TableFront& table, LogInfo& info) {
  std::optional<std::size_t> found;
  std::size_t named = 0;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const std::string stem = stem_of(table.columns[c]);
    if (find_time_name(stem) == nullptr) continue;
    ++named;
    if (!found || clock_of(stem) < clock_of(stem_of(table.columns[*found]))) found = c;
  }
  if (named > 1 && clock_of(stem_of(table.columns[*found])) == Clock::device)
    info.guesses.push_back(
        fmt::format("time column: {}, the device's own clock (`time_column` takes another one)",
                    printable(table.columns[*found].name)));
  return found;
}

// Without names: a first column that rises evenly.
std::optional<std::size_t> column_that_rises(const TableFront& table,
                                             const ReadOptions& options,
                                             LogInfo& info) {
  if (table.columns.size() < 2) return std::nullopt;
  if (!table.text && (options.rate_hz || info.time.rate_hz > 0)) return std::nullopt;
  const std::vector<double> values = table.first_values(0).values;
  if (!near_uniform_and_rising(values)) return std::nullopt;
  const bool counter = median_step(values) == 1 &&
                       values.back() - values.front() == static_cast<double>(values.size() - 1);
  if (counter || !table.text) {
    info.guesses.push_back(
        fmt::format("first column: {}, kept as a channel (`time_column` c0 takes it as time)",
                    counter ? "counts the rows by ones" : "rises evenly"));
    return std::nullopt;
  }
  info.guesses.emplace_back(
      "time column: the first, because it rises evenly (`time_column` none keeps it as a channel)");
  return 0;
}

std::int64_t unit_from_options(const std::string& word) {
  for (const char* known : {"s", "ms", "us", "ns"})
    if (word == known) return unit_in_ns(word);
  throw Error(
      {ErrorKind::usage, "E0323", "", "unknown time unit", word, "use auto, s, ms, us or ns"});
}

// As the name or the file says; 0 when neither does.
std::int64_t unit_said(const ColumnLabel& column) {
  const auto [stem, unit] = name_and_unit(column.name);
  if (const TimeName* known = find_time_name(stem); known && known->unit_ns != 0)
    return known->unit_ns;
  const std::int64_t apart = unit_in_ns(column.unit);
  return apart != 0 ? apart : unit_in_ns(unit);
}

}  // namespace

std::optional<std::size_t> find_time_column(const TableFront& table,
                                            const ReadOptions& options,
                                            LogInfo& info) {
  if (options.time_column == "none") return std::nullopt;
  if (options.time_column != "auto")
    return named_column(table, options.time_column, options, info.file);
  return table.named ? column_called_time(table, info) : column_that_rises(table, options, info);
}

std::int64_t find_time_unit(const TableFront& table,
                            std::size_t column,
                            const ReadOptions& options,
                            LogInfo& info) {
  std::int64_t unit = options.time_unit != "auto" ? unit_from_options(options.time_unit)
                                                  : unit_said(table.columns[column]);
  if (unit == 0) {
    unit = guess_unit(table.first_values(column));
    info.time.unit_guessed = true;
    info.guesses.push_back(fmt::format(
        "time unit: {}, from the size and step of the stamps (`time_unit` says otherwise)",
        unit_name(unit)));
  }
  info.time.unit = unit_name(unit);
  info.time.unit_ns = unit;
  return unit;
}

}  // namespace libchar

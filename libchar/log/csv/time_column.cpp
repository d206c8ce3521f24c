#include "libchar/log/csv/time_column.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "libchar/core/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/csv/number.hpp"

namespace libchar::csv {
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

const TimeName* time_name(std::string_view name) {
  const std::string wanted = ascii_lower(trimmed(name));
  for (const TimeName& known : kTimeNames)
    if (known.name == wanted) return &known;
  static constexpr TimeName other{"timestamp_", 0};
  return wanted.substr(0, 10) == "timestamp_" || wanted.substr(0, 10) == "timestamp " ? &other
                                                                                      : nullptr;
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

std::vector<double> first_values(const std::vector<std::vector<Field>>& rows,
                                 std::size_t column,
                                 char decimal) {
  std::vector<double> values;
  for (const auto& row : rows) {
    if (column >= row.size()) continue;
    const Cell cell = read_cell(row[column].text, decimal);
    if (cell.kind == Cell::value) values.push_back(cell.number);
  }
  return values;
}

double median_step(const std::vector<double>& values) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
  if (steps.empty()) return 0;
  std::nth_element(steps.begin(),
                   steps.begin() + static_cast<std::ptrdiff_t>((steps.size() - 1) / 2),
                   steps.end());
  return steps[(steps.size() - 1) / 2];
}

// Time since 1970 betrays its unit by size; a time since power-on by its step, as sensors run at
// 0.5 Hz to 50 kHz.
std::int64_t guess_unit(const std::vector<double>& values, bool integers) {
  const double size = values.empty() ? 0 : std::fabs(values[0]);
  if (size >= 1e17) return 1;
  if (size >= 1e14) return 1000;
  if (size >= 1e11 && size < 1e14) return 1000000;
  if (size >= 1e9 && size < 1e10 && !integers) return 1000000000;
  const double step = median_step(values);
  if (!integers && step < 2) return 1000000000;
  if (step < 2) return 1000000000;
  if (step < 200) return 1000000;
  if (step < 200000) return 1000;
  return 1;
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

bool calendar(std::string_view text) {
  const auto digits = [&](std::size_t from, std::size_t n) {
    for (std::size_t i = from; i < from + n; ++i)
      if (i >= text.size() || !is_digit(text[i])) return false;
    return true;
  };
  return (digits(0, 4) && text.size() > 7 && (text[4] == '-' || text[4] == '/') && digits(5, 2)) ||
         (digits(0, 2) && text.size() > 5 && text[2] == ':' && digits(3, 2));
}

int named_column(const Dialect& dialect, const std::string& wanted) {
  for (std::size_t i = 0; i < dialect.columns.size(); ++i)
    if (dialect.columns[i].name == wanted || dialect.columns[i].text == wanted)
      return static_cast<int>(i);
  if (wanted.size() > 1 && wanted[0] == 'c' &&
      wanted.find_first_not_of("0123456789", 1) == std::string::npos && wanted.size() < 8) {
    const int index = std::atoi(wanted.c_str() + 1);
    if (index < static_cast<int>(dialect.columns.size())) return index;
  }
  std::vector<std::string> names;
  for (const Column& column : dialect.columns) names.push_back(column.name);
  const auto near = nearest(wanted, names);
  throw Error({ErrorKind::usage,
               "E0320",
               "",
               "there is no column of this name for the time",
               wanted,
               near ? "did you mean " + *near + "?" : ""});
}

}  // namespace

void choose_time(Dialect& dialect,
                 const std::vector<std::vector<Field>>& rows,
                 const ReadOptions& options,
                 LogInfo& info) {
  std::int64_t unit = 0;
  if (options.time_column == "none") return;
  if (options.time_column != "auto") {
    dialect.time_column = named_column(dialect, options.time_column);
  } else if (dialect.has_header) {
    for (std::size_t i = 0; i < dialect.columns.size() && dialect.time_column < 0; ++i)
      if (const TimeName* known = time_name(dialect.columns[i].name)) {
        dialect.time_column = static_cast<int>(i);
        unit = known->unit_ns;
      }
  } else if (dialect.columns.size() > 1) {
    const auto values = first_values(rows, 0, dialect.decimal);
    if (near_uniform_and_rising(values)) {
      const double step = median_step(values);
      const bool counter =
          step == 1 && values.back() - values.front() == static_cast<double>(values.size() - 1);
      if (counter) {
        info.guesses.emplace_back(
            "first column: counts the rows by ones, kept as a channel (--time-column c0 takes it "
            "as time)");
      } else {
        dialect.time_column = 0;
        info.guesses.emplace_back(
            "time column: the first, because it rises evenly (--time-column none keeps it as a "
            "channel)");
      }
    }
  }
  if (dialect.time_column < 0) return;
  const auto index = static_cast<std::size_t>(dialect.time_column);
  Column& column = dialect.columns[index];
  bool integers = true;
  for (const auto& row : rows) {
    if (index >= row.size()) continue;
    integers = integers && row[index].text.find_first_of(".,eE") == std::string::npos;
  }
  if (!rows.empty() && index < rows[0].size() && calendar(rows[0][index].text))
    throw Error(
        {ErrorKind::input,
         "E0321",
         fmt::format("{}:{}:{}", info.file, dialect.first_data_line, rows[0][index].offset + 1),
         "calendar dates and clock times are not read as stamps, a number was expected",
         rows[0][index].text,
         "--time-column none --rate HZ with --channel leaves the column out, or convert it to "
         "seconds"});
  if (options.time_unit != "auto") {
    unit = options.time_unit == "s" || options.time_unit == "ms" || options.time_unit == "us" ||
                   options.time_unit == "ns"
               ? unit_in_ns(options.time_unit)
               : 0;
    if (unit == 0)
      throw Error({ErrorKind::usage,
                   "",
                   "",
                   "unknown time unit",
                   options.time_unit,
                   "use auto, s, ms, us or ns"});
  } else if (unit == 0) {
    unit = unit_in_ns(column.unit);
    if (unit == 0) {
      unit = guess_unit(first_values(rows, index, dialect.decimal), integers);
      info.time.unit_guessed = true;
      info.guesses.push_back(fmt::format(
          "time unit: {}, from the size and step of the stamps (--time-unit says otherwise)",
          unit_name(unit)));
    }
  }
  dialect.time_unit_ns = unit;
  info.time.unit = unit_name(unit);
  info.time.column = column.name.empty() ? fmt::format("c{}", index) : column.name;
}

}  // namespace libchar::csv

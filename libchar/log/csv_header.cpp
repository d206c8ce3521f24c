#include "libchar/log/csv_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>

#include "libchar/core/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/csv_number.hpp"

namespace libchar::csv {
namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

// A unit behind '_': one letter alone is a unit only where nobody uses it otherwise (gyro_x keeps
// its x, o3_1 its 1).
std::optional<std::string> unit_suffix(std::string_view name, std::string_view suffix) {
  if (suffix.empty() || is_digit(suffix[0]) || suffix == "-") return std::nullopt;
  if (suffix.size() == 1 && suffix != "g" && suffix != "s" && suffix != "V" && suffix != "K") {
    const bool celsius =
        (suffix == "C" || suffix == "c") && lower(name).find("temp") != std::string::npos;
    return celsius ? std::optional<std::string>("degC") : std::nullopt;
  }
  if (suffix == "none" || suffix == "min" || suffix == "rad" || suffix == "bar" ||
      suffix == "volt") {
    if (suffix == "none" || suffix == "min") return std::nullopt;  // "speed_min" is a minimum
  }
  if (find_unit(suffix)) return std::string(suffix);
  // rad_s, m_s2, deg_s: '_' in place of '/'
  std::string spelled(suffix);
  if (const std::size_t low = spelled.find('_'); low != std::string::npos) {
    spelled[low] = '/';
    if (find_unit(spelled)) return spelled;
  }
  return std::nullopt;
}

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
  const std::string wanted = lower(trimmed(name));
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

std::string place_name(std::uint64_t line, std::uint64_t column) {
  return column <= 1 ? fmt::format("line {}", line)
                     : fmt::format("line {}, column {}", line, column);
}

std::string latin1_to_utf8(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      out += c;
    } else {
      out += static_cast<char>(0xC0U | (byte >> 6U));
      out += static_cast<char>(0x80U | (byte & 0x3FU));
    }
  }
  return out;
}

std::pair<std::string, std::string> name_and_unit(std::string_view cell) {
  cell = trimmed(cell);
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    if (cell.empty() || cell.back() != close) continue;
    const std::size_t at = cell.rfind(open);
    if (at == std::string_view::npos || at == 0) continue;
    const std::string_view name = trimmed(cell.substr(0, at));
    const std::string_view unit = trimmed(cell.substr(at + 1, cell.size() - at - 2));
    // gyro(1), gyro(2): an index, not a unit
    const bool index = unit.find_first_not_of("0123456789") == std::string_view::npos;
    if (!name.empty() && !index && unit.size() <= 40 && unit.find('"') == std::string_view::npos)
      return {std::string(name), std::string(unit)};
  }
  for (std::size_t low = cell.find('_'); low != std::string_view::npos;
       low = cell.find('_', low + 1)) {
    if (low == 0) continue;
    if (const auto unit = unit_suffix(cell.substr(0, low), cell.substr(low + 1)))
      return {std::string(cell.substr(0, low)), *unit};
  }
  return {std::string(cell), ""};
}

void name_columns(Dialect& dialect, LogInfo& info) {
  std::map<std::string, int> stripped;
  for (Column& column : dialect.columns) {
    std::tie(column.name, column.unit) = name_and_unit(column.text);
    ++stripped[column.name];
  }
  std::map<std::string, const Column*> seen;
  for (std::size_t i = 0; i < dialect.columns.size(); ++i) {
    Column& column = dialect.columns[i];
    if (!dialect.has_header) continue;
    if (column.name.empty()) {
      column.name = fmt::format("c{}", i);
      info.warnings.add("unnamed_column",
                        "columns without a name are named by their position, c0, c1…",
                        place_name(column.line, column.position));
    } else if (stripped[column.name] > 1) {
      column.name =
          std::string(trimmed(column.text));  // acc_g beside acc_mg: the full texts differ
    }
    if (std::string_view("=+-@\t\r").find(column.name[0]) != std::string_view::npos)
      info.warnings.add("formula_name",
                        "channel names that a spreadsheet would run as a formula: kept, and "
                        "prefixed with ' in CSV that is written",
                        place_name(column.line, column.position));
    if (printable(column.name).find("\\u{") != std::string::npos ||
        printable(column.name).find("\\x") != std::string::npos)
      info.warnings.add(
          "control_in_name",
          "channel names with invisible or direction-changing characters: shown escaped",
          place_name(column.line, column.position));
    const auto [other, fresh] = seen.emplace(column.name, &column);
    if (!fresh)
      throw Error({ErrorKind::input,
                   "E0307",
                   fmt::format("{}:{}:{}", info.file, column.line, column.position),
                   fmt::format("two columns have the same name (first at {}:{})",
                               other->second->line,
                               other->second->position),
                   column.name,
                   "rename one, or read with --header no --skip-rows 1 to use positions"});
  }
}

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

void read_rate_comment(std::string_view comment, LogInfo& info) {
  const std::string text = lower(comment);
  const std::size_t word = text.find("rate");
  const std::size_t hz = text.find("hz", word == std::string::npos ? 0 : word);
  if (word == std::string::npos || hz == std::string::npos) return;
  std::string number = text.substr(word + 4, hz - word - 4);
  number.erase(0, number.find_first_of("0123456789"));
  const double factor = !number.empty() && number.back() == 'k' ? 1000 : 1;
  number.erase(number.find_last_of("0123456789.") + 1);
  const auto rate = parse_double(number);
  if (!rate || !(*rate > 0)) return;
  info.time.rate_hz = *rate * factor;
  info.dialect.push_back(fmt::format("rate {} Hz from a comment", shortest(info.time.rate_hz)));
}

}  // namespace libchar::csv

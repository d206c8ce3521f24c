// The unit of the stamps: said, or guessed from their size and step and held against a rate that the file states.

#include <fmt/format.h>

#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/detail/column_name.hpp"
#include "libchar/log/time/time_column.hpp"

namespace libchar {
namespace {

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
    case 100000:
      return "100us";
    default:
      return fmt::format("{} ns", ns);
  }
}

std::int64_t unit_by_step(double step) {
  if (step < 2) return 1000000000;
  if (step < 200) return 1000000;
  return step < 200000 ? 1000 : 1;
}

bool whole_thousands(const std::vector<double>& values) {
  return std::all_of(
      values.begin(), values.end(), [](double x) { return std::fmod(x, 1000) == 0; });
}

// Time since 1970 betrays its unit by its size, where that is a date from 1990 to 2100; a time
// since power-on by its step, as sensors run at 0.5 Hz to 50 kHz. A phone that has run for half an
// hour counts as many nanoseconds as a date has milliseconds: then the step decides, unless all are
// whole seconds.
std::int64_t guess_unit(const FirstValues& first) {
  constexpr double kFirstDate = 6.3e8, kLastDate = 4.1e9;  // in seconds
  const std::vector<double>& values = first.values;
  const double size = values.empty() ? 0 : std::fabs(values[0]);
  const double step = usual_step(values);
  const auto dated = [&](double in_seconds) {
    return size >= kFirstDate * in_seconds && size < kLastDate * in_seconds;
  };
  if (size >= 1e17) return 1;
  if (dated(1e6)) return 1000;
  if (dated(1e3) && (step < 200000 || whole_thousands(values))) return 1000000;
  if (size >= 1e9 && size < 1e10 && !first.integers) return 1000000000;
  // Whole seconds since 1970 every few seconds; milliseconds would be three weeks since power-on.
  if (size >= 1.2e9 && size < 2.2e9 && step < 200) return 1000000000;
  return unit_by_step(step);
}

std::int64_t unit_from_options(const std::string& word) {
  for (const char* known : {"s", "ms", "us", "ns"})
    if (word == known) return unit_in_ns(word);
  if (word == "100us") return 100000;
  throw Error({ErrorKind::usage,
               "E0323",
               "",
               "unknown time unit",
               word,
               "use auto, s, ms, us, ns or 100us"});
}

// As the name or the file says; 0 when neither does.
std::int64_t unit_said(const ColumnLabel& column) {
  const auto [stem, unit] = name_and_unit(column.name);
  if (const auto known = time_name(stem); known && known->unit_ns != 0) return known->unit_ns;
  const std::int64_t apart = unit_in_ns(column.unit);
  return apart != 0 ? apart : unit_in_ns(unit);
}

// Xsens devices count SampleTimeFine by 0.1 ms or by 1 us, at 1 to 2000 Hz the one, at 1 to 120 Hz the other.
std::int64_t guess_fine(const FirstValues& first) {
  return usual_step(first.values) < 2000 ? 100000 : 1000;
}

double rate_in(double step, std::int64_t unit_ns) {
  return 1e9 / (step * static_cast<double>(unit_ns));
}

bool rates_agree(double rate_hz, double stated_hz) {
  return rate_hz > 0.8 * stated_hz && rate_hz < 1.25 * stated_hz;
}

// The unit in which the stamps run at the rate that the file states.
std::int64_t unit_of_rate(std::int64_t guess, double step, double stated_hz, const LogInfo& info) {
  if (rates_agree(rate_in(step, guess), stated_hz)) return guess;
  for (const std::int64_t unit : {std::int64_t{1},
                                  std::int64_t{1000},
                                  std::int64_t{100000},
                                  std::int64_t{1000000},
                                  std::int64_t{1000000000}})
    if (rates_agree(rate_in(step, unit), stated_hz)) return unit;
  throw Error({ErrorKind::input,
               "E0325",
               info.file,
               fmt::format("the file states {} Hz, and its stamps step by {}, which is {} Hz in {} "
                           "and fits in no unit",
                           shortest(stated_hz),
                           brief_text(step, 6),
                           brief_text(rate_in(step, guess), 6),
                           unit_name(guess)),
               "",
               "`time_unit` s|ms|us|ns believes the stamps, `time_column` none with `rate_hz` the "
               "stated rate"});
}

void warn_of_stated_rate(const TableFront& table, double step, std::int64_t unit, LogInfo& info) {
  const double rate = rate_in(step, unit);
  if (rates_agree(rate, *table.stated_rate_hz)) return;
  info.warnings.add("stated_rate",
                    "the file states another rate than its stamps have: the stamps are believed",
                    fmt::format("{} Hz stated, {} Hz by the stamps",
                                shortest(*table.stated_rate_hz),
                                brief_text(rate, 6)));
}

}  // namespace

std::int64_t find_time_unit(const TableFront& table,
                            std::size_t column,
                            const ReadOptions& options,
                            LogInfo& info) {
  std::int64_t unit = options.time_unit != "auto" ? unit_from_options(options.time_unit)
                                                  : unit_said(table.columns[column]);
  const FirstValues first = table.first_values(column);
  const double step = usual_step(first.values);
  const bool comparable = table.stated_rate_hz && step > 0 && first.values.size() > 3;
  if (unit == 0) {
    const bool fine =
        ascii_lower(name_and_unit(table.columns[column].name).first) == "sampletimefine";
    const std::int64_t guess = fine ? guess_fine(first) : guess_unit(first);
    unit = comparable ? unit_of_rate(guess, step, *table.stated_rate_hz, info) : guess;
    info.time.unit_guessed = true;
    info.guesses.push_back(fmt::format(
        "time unit: {}, from {} (`time_unit` says otherwise)",
        unit_name(unit),
        comparable
            ? fmt::format("the rate of {} Hz that the file states", shortest(*table.stated_rate_hz))
            : "the size and step of the stamps"));
  } else if (comparable) {
    warn_of_stated_rate(table, step, unit, info);
  }
  info.time.unit = unit_name(unit);
  info.time.unit_ns = unit;
  return unit;
}

}  // namespace libchar

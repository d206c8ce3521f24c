// The unit of the stamps: said, or guessed from their size and step and held against a rate that the file states.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/detail/column_name.hpp"
#include "libchar/log/time/time_column.hpp"

namespace libchar {
namespace {

constexpr std::int64_t kDayNs = 86400000000000;

struct NamedUnit {
  const char* name;
  std::int64_t ns;
};
constexpr std::array kNamedUnits = {
    NamedUnit{"s", 1000000000}, NamedUnit{"ms", 1000000}, NamedUnit{"us", 1000},         NamedUnit{"ns", 1},
    NamedUnit{"100us", 100000}, NamedUnit{"100ns", 100},  NamedUnit{"min", 60000000000}, NamedUnit{"h", 3600000000000},
    NamedUnit{"d", kDayNs}};

std::string unit_name(std::int64_t ns) {
  for (const NamedUnit& unit : kNamedUnits)
    if (unit.ns == ns) return unit.name;
  return fmt::format("{} ns", ns);
}

/// Counts that began long before 1970, by their number at its beginning; stamps of 1990 to 2100 are told by their size.
struct OldCount {
  const char* name;
  const char* word;  // in a column's name, which decides between two of one size
  std::int64_t unit_ns;
  double of_1970;
};
constexpr std::array kOldCounts = {OldCount{"days since 1858-11-17 (MJD)", "mjd", kDayNs, 40587},
                                   OldCount{"days of a spreadsheet, since 1899-12-30", "", kDayNs, 25569},
                                   OldCount{"days of MATLAB's datenum", "", kDayNs, 719529},
                                   OldCount{"Julian days", "", kDayNs, 2440587.5},
                                   OldCount{"100 ns since 0001-01-01 (.NET)", "", 100, 621355968e9},
                                   OldCount{"100 ns since 1601-01-01 (Windows)", "", 100, 116444736e9}};

bool few_digits(double step) { return std::fabs(step - rounded(step, 3)) <= 1e-6 * step; }

/// Fractions of days that make 20, 30 or 60 s in the mean, whose steps are rounded to few digits.
bool minutes_in_days(const std::vector<double>& values) {
  const double seconds = (values.back() - values.front()) / static_cast<double>(values.size() - 1) * 86400;
  return std::fabs(seconds - 10 * std::round(seconds / 10)) < 1e-3 * seconds && seconds > 19 && seconds < 61;
}

/// Seconds that a program kept in 32 bits: after half a day they step by 1/128 s, which no fraction of a day does but
/// in whole quarters of an hour.
bool seconds_of_32_bits(double step) {
  constexpr double kPart = 1024, kOff = 1e-3;
  const double parts = std::round(step * kPart);
  return parts > 0 && std::fabs(step * kPart - parts) < kOff;
}

/// Fractions of days: their steps are odd numbers that make whole milliseconds, or of no sensor when taken as seconds.
const OldCount* old_count(const std::string& stem, const FirstValues& first, std::int64_t unit_ns) {
  constexpr double kFrom = 7305, kTo = 47482, kFastest = 2e-4;  // days: 1990, 2100
  const std::string name = ascii_lower(stem);
  if (first.values.empty()) return nullptr;
  const double step = usual_step(first.values), size = first.values[0];
  constexpr double kFour = 1e4;  // decimals: more of them, in first rows that share a stamp, are no seconds
  const bool fine = std::fabs(size * kFour - std::round(size * kFour)) > 1e-3;
  for (const OldCount& count : kOldCounts) {
    const bool said = *count.word != '\0' && name.find(count.word) != std::string::npos;
    if ((*count.word != '\0' && !said) || (unit_ns != 0 && unit_ns != count.unit_ns)) continue;
    const double days = (size - count.of_1970) * static_cast<double>(count.unit_ns) / static_cast<double>(kDayNs);
    if (days < kFrom || days > kTo) continue;
    const bool fractions = !first.integers && (step > 0 || fine) && step < 1 && !seconds_of_32_bits(step) &&
                           (step < kFastest || !few_digits(step) || minutes_in_days(first.values));
    if (said || (count.unit_ns == kDayNs ? fractions : first.integers)) return &count;
  }
  return nullptr;
}

std::int64_t unit_by_step(double step) {
  if (step < 2) return 1000000000;
  if (step < 200) return 1000000;
  return step < 200000 ? 1000 : 1;
}

bool whole_thousands(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::fmod(x, 1000) == 0; });
}

double rate_in(double step, std::int64_t unit_ns) { return 1e9 / (step * static_cast<double>(unit_ns)); }

constexpr std::array kStampUnits = {std::int64_t{1000000000}, std::int64_t{1000000}, std::int64_t{1000},
                                    std::int64_t{1}};

/// Intervals at which sensors and loggers are read: whole rates up to 2 kHz in fives, or the usual pauses.
bool usual_interval(double seconds) {
  constexpr std::array kPauses = {1, 2, 5, 10, 15, 20, 30, 60, 120, 180, 300, 600, 900, 1200, 1800, 3600, 7200, 86400};
  if (seconds >= 1)
    return std::any_of(kPauses.begin(), kPauses.end(), [&](int s) { return std::fabs(seconds - s) < 1e-9 * s; });
  const double rate = 1 / seconds;
  const double unit = rate < 5 ? 1 : 5;
  return rate <= 2000 && std::fabs(rate - unit * std::round(rate / unit)) < 1e-9 * rate;
}

/// Pauses are kept to a thousandth, and a device's clock is no better.
bool near_a_usual_interval(double seconds) {
  constexpr double kDigits = 1e3;
  const double decade = std::pow(10, std::floor(std::log10(seconds)));
  return seconds >= 0.2 && usual_interval(std::round(seconds / decade * kDigits) / kDigits * decade);
}

/// The step of whole numbers is a usual interval in these units; nobody counts ten seconds and more in fractions.
std::vector<std::int64_t> usual_units(double step) {
  constexpr double kLongest = 5, kLongestOfMicros = 10;  // as ns at 100 Hz
  std::vector<std::int64_t> out;
  for (const std::int64_t unit : kStampUnits) {
    const double seconds = step * 1e-9 * static_cast<double>(unit);
    if (step > 1 && usual_interval(seconds) &&
        (unit == kStampUnits[0] || seconds <= (unit == 1000 ? kLongestOfMicros : kLongest)))
      out.push_back(unit);
  }
  return out;
}

/// Counts that wander by a few of a million: a device's microseconds do, nanoseconds never keep to so few.
bool wanders_by_ones(const std::vector<double>& values, double step) {
  constexpr double kFew = 20, kLongStep = 2e5;
  double most = 0;
  for (std::size_t i = 1; i < values.size(); ++i) most = std::max(most, std::fabs(values[i] - values[i - 1] - step));
  return step >= kLongStep && most > 0 && most <= kFew;
}

/// Seconds from before 2015 are as well milliseconds of a device that has been on for two weeks.
bool says_a_date(const FirstValues& first) { return first.values.empty() || std::fabs(first.values[0]) >= 1.42e9; }

/// Whole numbers that follow each other by ones, and by none and by twos.
bool uneven_ones(const FirstValues& first) {
  const std::vector<double>& values = first.values;
  bool even = true;
  for (std::size_t i = 1; i < values.size(); ++i) even = even && values[i] - values[i - 1] == 1;
  return first.integers && usual_step(values) == 1 && !even;
}

// Time since 1970 betrays its unit by its size, where that is a date from 2001 to 2100; a time since power-on by its
// step, as sensors run at 0.5 Hz to 50 kHz. A phone that has run for half an hour counts as many nanoseconds as a date
// has milliseconds: then the step decides, unless all are whole seconds.
std::int64_t guess_unit(const FirstValues& first) {
  constexpr double kFirstDate = 1e9, kLastDate = 4.1e9;  // in seconds
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
  // Minutes and hours between dates since 2015; microseconds would be from the 24th to the 32nd minute since power-on.
  constexpr double kHours = 1e5;
  if (first.integers && size >= 1.42e9 && size < 1.9e9 && step < kHours) return 1000000000;
  constexpr double kLongOn = 1e4;  // three hours in s, ten seconds in ms
  if (uneven_ones(first) && size >= kLongOn) return 1000000;
  const std::int64_t by_step = unit_by_step(step);
  if (first.integers && wanders_by_ones(values, step)) return kStampUnits[2];
  if (says_a_date(first)) return by_step;
  const std::vector<std::int64_t> usual = usual_units(step);
  constexpr double kMinute = 60;
  return usual.size() == 1 && usual.front() == kStampUnits[0] && step >= kMinute ? usual.front() : by_step;
}

/// Nobody reads accelerometers and gyroscopes, or x, y and z, once a minute; phones do every 60 ms.
bool inertial(const TableFront& table) {
  static constexpr std::array<std::string_view, 6> kNames = {"acc", "gyr", "ax", "gx", "linear_acc", "lin_acc"};
  std::size_t axes = 0;
  for (const ColumnLabel& column : table.columns) {
    const auto [stem, behind] = name_and_unit(column.name);
    const auto unit = find_unit(column.unit.empty() ? behind : column.unit);
    const std::string name = ascii_lower(stem);
    axes += name == "x" || name == "y" || name == "z";
    if ((unit && (unit->quantity == Quantity::angular_rate || unit->quantity == Quantity::acceleration)) ||
        std::any_of(kNames.begin(), kNames.end(), [&](std::string_view front) { return name.starts_with(front); }))
      return true;
  }
  return axes == 3;
}

/// Thermometers, and what is logged with them: every few seconds or minutes, not 33 times a second.
bool weather(const TableFront& table, std::size_t time) {
  bool any = false;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const ColumnLabel& column = table.columns[c];
    if (c == time || column.text || column.calendar) continue;
    const auto unit = find_unit(column.unit.empty() ? name_and_unit(column.name).second : column.unit);
    if (!unit) return false;
    const Quantity q = unit->quantity;
    any = any || q == Quantity::temperature;
    if (q != Quantity::temperature && q != Quantity::ratio && q != Quantity::pressure && q != Quantity::concentration)
      return false;
  }
  return any;
}

constexpr std::size_t kFewest = 4;  // stamps: of less the first cell that is no number is what is wrong

/// Of text without names: microseconds may be nanoseconds, and milliseconds microseconds, where both make a usual rate.
std::vector<std::int64_t> units_without_a_name(const FirstValues& first, std::int64_t unit) {
  constexpr double kSince = 1e13;  // nobody's microseconds begin as late
  const double step = usual_step(first.values), coarser = step * static_cast<double>(unit) * 1e-6;
  const bool counted = first.integers && (unit == kStampUnits[2] || unit == kStampUnits[3]) && first.values[0] < kSince;
  if (!counted || first.values.size() < kFewest || wanders_by_ones(first.values, step) ||
      !near_a_usual_interval(coarser))
    return {};
  return {unit * 1000, unit};
}

/// Whole numbers with one step, of no usual interval in any unit.
bool counts_of_a_timer(const FirstValues& first) {
  const std::vector<double>& values = first.values;
  const double step = usual_step(values);
  bool even = first.integers && step > 1 && usual_units(step).empty();
  for (std::size_t i = 1; i < values.size() && even; ++i) even = values[i] - values[i - 1] == step;
  return even;
}

/// Seconds or milliseconds by another clock of the table whose unit is known: dates, or the time since 1970.
std::int64_t unit_by_another_clock(const TableFront& table, std::size_t column, double step) {
  constexpr double kAlike = 0.1, kFirst = 1e9, kLast = 4.1e9;  // s
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (c == column || table.columns[c].text) continue;
    const std::vector<double> values = table.first_values(c).values;
    double seconds = values.size() < 3 ? 0 : usual_step(values);
    if (!(seconds > 0) || !std::is_sorted(values.begin(), values.end())) continue;
    const bool since_1970 = values[0] > kFirst && values[0] < kLast;
    if (values[0] > 1e3 * kFirst && values[0] < 1e3 * kLast)
      seconds /= 1e3;
    else if (!since_1970 && !table.columns[c].calendar)
      continue;
    for (const std::int64_t unit : {kStampUnits[0], kStampUnits[1]})
      if (std::fabs(step * 1e-9 * static_cast<double>(unit) - seconds) < kAlike * seconds) return unit;
  }
  return 0;
}

/// A loop that waits so long takes a little more or less: delay(500) of an Arduino steps by 498 or 503.
bool near_a_pause(double seconds) {
  constexpr std::array kPauses = {0.2, 0.25, 0.5, 1.0, 2.0, 5.0};
  constexpr double kNear = 0.02;
  return std::any_of(kPauses.begin(), kPauses.end(), [&](double s) { return std::fabs(seconds - s) < kNear * s; });
}

[[noreturn]] void refuse_without_unit(double step, const std::vector<std::int64_t>& both, const LogInfo& info) {
  const std::string one = unit_name(both[0]), other = unit_name(both[1]);
  throw input_error("E0325", info.file)
      .says("the stamps state no unit: their step of {} is {} Hz in {} and {} Hz in {}", brief_text(step, 6),
            brief_text(rate_in(step, both[0]), 6), one, brief_text(rate_in(step, both[1]), 6), other)
      .hint("`time_unit` {} or `time_unit` {} decides", one, other);
}

/// The unit that the steps alone say, and which other one they might mean; false where they say seconds only.
bool say_guess_by_step(const TableFront& table, const FirstValues& first, std::int64_t unit, LogInfo& info) {
  const double step = usual_step(first.values);
  if (!first.integers && unit == kStampUnits[1] && first.values.size() >= kFewest && !inertial(table))
    refuse_without_unit(step, {kStampUnits[0], unit}, info);
  std::vector<std::int64_t> units = first.integers ? usual_units(step) : std::vector<std::int64_t>{};
  if (uneven_ones(first) || (!first.integers && unit == kStampUnits[1])) units = {kStampUnits[0], kStampUnits[1]};
  const auto add = [&](std::vector<std::int64_t>::const_iterator where, std::int64_t one) {
    if (std::find(units.begin(), units.end(), one) == units.end()) units.insert(where, one);
  };
  add(units.begin(), unit);
  if (first.integers && unit == kStampUnits[2] && near_a_pause(step * 1e-3)) add(units.end(), kStampUnits[1]);
  constexpr double kSlowest = 200;  // of sensors in ms
  if (units.size() == 1 && unit == kStampUnits[0]) {
    if (!(step > 1 && step < kSlowest)) return false;
    units.push_back(kStampUnits[1]);
  }
  Finding& guess = info.warnings.add(
      "time_unit_guessed", fmt::format("the stamps state no unit: taken as {} by their step of {}, {} Hz",
                                       unit_name(unit), brief_text(step, 6), brief_text(rate_in(step, unit), 6)));
  guess.severity = units.size() > 1 || counts_of_a_timer(first) ? Severity::caution : Severity::note;
  for (const std::int64_t one : units)
    guess.help.push_back({fmt::format("{}: {} Hz.", unit_name(one), brief_text(rate_in(step, one), 6)),
                          {{"time_unit", unit_name(one)}}});
  return true;
}

std::int64_t unit_from_options(const std::string& word) {
  for (const NamedUnit& unit : kNamedUnits)
    if (word == unit.name) return unit.ns;
  throw usage_error("E0323")
      .says("unknown time unit")
      .got(word)
      .hint("use auto, s, ms, us, ns, min, h, d, 100us or 100ns");
}

// Xsens devices count SampleTimeFine by 0.1 ms or by 1 us, at 1 to 2000 Hz the one, at 1 to 120 Hz the other.
std::int64_t guess_fine(const FirstValues& first) { return usual_step(first.values) < 2000 ? 100000 : 1000; }

/// A week has fewer seconds than that, and nobody samples a receiver every few microseconds: whatever the name usually
/// means.
std::int64_t unit_in_the_week(const std::string& stem, const FirstValues& first, std::int64_t said) {
  constexpr double kWeek = 604800, kFastest = 0.05;  // s; steps in ms
  const std::string name = ascii_lower(stem);
  if (!(name.ends_with("tow") || name.ends_with("sow")) || first.values.empty()) return said;
  if (said == kStampUnits[0] && first.values[0] > kWeek) return kStampUnits[1];
  const double step = usual_step(first.values);
  return said == kStampUnits[1] && step > 0 && step < kFastest ? kStampUnits[0] : said;
}

bool rates_agree(double rate_hz, double stated_hz) { return rate_hz > 0.8 * stated_hz && rate_hz < 1.25 * stated_hz; }

// The unit in which the stamps run at the rate that the file states: by their usual step, or by the mean one where they
// come in bursts, or by the shortest ones where many rows are missing.
std::int64_t unit_of_rate(std::int64_t guess, const std::vector<double>& values, double stated_hz,
                          const LogInfo& info) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
  std::sort(steps.begin(), steps.end());
  const double step = steps[(steps.size() - 1) / 2];
  const double mean = (values.back() - values.front()) / static_cast<double>(steps.size());
  for (const double one : {step, mean, steps[steps.size() / 10]}) {
    if (!(one > 0)) continue;
    if (rates_agree(rate_in(one, guess), stated_hz)) return guess;
    for (const NamedUnit& unit : kNamedUnits)
      if (rates_agree(rate_in(one, unit.ns), stated_hz)) return unit.ns;
  }
  throw input_error("E0325", info.file)
      .says("the file states {} Hz, and its stamps step by {}, which is {} Hz in {} and fits in no unit",
            shortest(stated_hz), brief_text(step, 6), brief_text(rate_in(step, guess), 6), unit_name(guess))
      .hint("`time_unit` s|ms|us|ns believes the stamps, `time_column` none with `rate_hz` the stated rate");
}

void warn_of_stated_rate(const TableFront& table, double step, std::int64_t unit, LogInfo& info) {
  const double rate = rate_in(step, unit);
  if (rates_agree(rate, *table.stated_rate_hz)) return;
  info.warnings.add(
      "stated_rate", "the file states another rate than its stamps have: the stamps are believed",
      fmt::format("{} Hz stated, {} Hz by the stamps", shortest(*table.stated_rate_hz), brief_text(rate, 6)));
}

}  // namespace

StampUnit find_time_unit(const TableFront& table, std::size_t column, const ReadOptions& options, LogInfo& info) {
  const std::string stem = name_and_unit(table.columns[column].name).first;
  StampUnit unit{options.time_unit != "auto" ? unit_from_options(options.time_unit) : unit_said(table.columns[column])};
  if (unit.ns == 0 && table.stated_tick_s) {
    unit.ns = std::max<std::int64_t>(1, clamped_whole<std::int64_t>(std::round(*table.stated_tick_s * 1e9)));
    info.dialect.push_back(fmt::format("stamps count {} s each, from the preamble", shortest(*table.stated_tick_s)));
  }
  FirstValues first = table.first_values(column);
  if (options.time_unit == "auto" && unit_behind(table.columns[column]) == 0)
    unit.ns = unit_in_the_week(stem, first, unit.ns);
  if (usual_step(first.values) == 0)  // rows of several sources share their stamps
    first.values.erase(std::unique(first.values.begin(), first.values.end()), first.values.end());
  const double step = usual_step(first.values);
  const bool comparable = table.stated_rate_hz && step > 0 && first.values.size() > 3;
  if (const OldCount* count = old_count(stem, first, unit.ns); count != nullptr) {
    unit = {count->unit_ns, count->of_1970};
    info.time.unit_guessed = options.time_unit == "auto";
    info.guesses.push_back(
        fmt::format("time: {}, from the size of the stamps (`time_unit` says otherwise)", count->name));
  } else if (unit.ns == 0) {
    std::int64_t guess = ascii_lower(stem) == "sampletimefine" ? guess_fine(first) : guess_unit(first);
    constexpr double kSlow = 5;  // s
    if (guess == kStampUnits[0] && first.integers && step > kSlow && !says_a_date(first) && inertial(table))
      guess = kStampUnits[1];
    if (guess == kStampUnits[1] && first.integers && !says_a_date(first) && usual_interval(step) &&
        weather(table, column))
      guess = kStampUnits[0];
    unit.ns = comparable ? unit_of_rate(guess, first.values, *table.stated_rate_hz, info) : guess;
    info.time.unit_guessed = true;
    const std::int64_t other = comparable || first.integers ? 0 : unit_by_another_clock(table, column, step);
    if (other > 0) unit.ns = other;
    if (!comparable && !table.named)
      if (const std::vector<std::int64_t> both = units_without_a_name(first, unit.ns); !both.empty())
        refuse_without_unit(step, both, info);
    const bool by_step = !comparable && other == 0 && !says_a_date(first) && first.values.size() > 1;
    if (!by_step || !say_guess_by_step(table, first, unit.ns, info))
      info.guesses.push_back(fmt::format(
          "time unit: {}, from {} (`time_unit` says otherwise)", unit_name(unit.ns),
          comparable  ? fmt::format("the rate of {} Hz that the file states", shortest(*table.stated_rate_hz))
          : other > 0 ? "the steps of another clock in the table"
                      : "the size and step of the stamps"));
  } else if (comparable) {
    warn_of_stated_rate(table, step, unit.ns, info);
  }
  info.time.unit = unit_name(unit.ns);
  info.time.unit_ns = unit.ns;
  return unit;
}

}  // namespace libchar

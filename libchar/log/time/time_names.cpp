// Names that say time, in the languages that spreadsheets speak, and the units that stand with them.

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/detail/column_name.hpp"
#include "libchar/log/time/time_column.hpp"

namespace libchar {

namespace {

struct KnownName {
  std::string_view name;
  std::int64_t unit_ns = 0;  // 0 = not said by the name
};

template <std::size_t N>
bool among(const std::array<std::string_view, N>& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

constexpr std::array kTimeNames = {KnownName{"time"},
                                   KnownName{"timestamp"},
                                   KnownName{"time stamp"},
                                   KnownName{"timestamps"},
                                   KnownName{"stamp"},
                                   KnownName{"times"},
                                   KnownName{"elapsed"},
                                   KnownName{"elapsed time"},
                                   KnownName{"time elapsed"},
                                   KnownName{"time since start"},
                                   KnownName{"total time"},
                                   KnownName{"cumulative time"},
                                   KnownName{"test time"},
                                   KnownName{"relative time"},
                                   KnownName{"uptime"},
                                   KnownName{"sampletime"},
                                   KnownName{"datetime"},
                                   KnownName{"date time"},
                                   KnownName{"date/time"},
                                   KnownName{"unix time"},
                                   KnownName{"unixtime"},
                                   KnownName{"gps time"},
                                   KnownName{"host time"},
                                   KnownName{"sample time"},
                                   KnownName{"epoch"},
                                   KnownName{"epoch time"},
                                   KnownName{"zeit"},
                                   KnownName{"zeitstempel"},
                                   KnownName{"datum/zeit"},
                                   KnownName{"temps"},
                                   KnownName{"horodatage"},
                                   KnownName{"tiempo"},
                                   KnownName{"tempo"},
                                   KnownName{"tijd"},
                                   KnownName{"tid"},
                                   KnownName{"czas"},
                                   KnownName{"aika"},
                                   KnownName{"cas"},
                                   KnownName{"timeus", 1000},
                                   KnownName{"timems", 1000000},
                                   KnownName{"utime", 1000},
                                   KnownName{"seconds", 1000000000},
                                   KnownName{"seconds elapsed", 1000000000},
                                   KnownName{"elapsed seconds", 1000000000},
                                   KnownName{"sec", 1000000000},
                                   KnownName{"secs", 1000000000},
                                   KnownName{"second", 1000000000},
                                   KnownName{"x value", 1000000000},  // LabVIEW measurement files
                                   KnownName{"millis", 1000000},
                                   KnownName{"milliseconds", 1000000},
                                   KnownName{"micros", 1000},
                                   KnownName{"\xE6\x97\xB6\xE9\x97\xB4"},  // Chinese
                                   KnownName{"\xE6\x97\xB6\xE9\x97\xB4\xE6\x88\xB3"},
                                   KnownName{"\xE6\x99\x82\xE9\x96\x93"},
                                   KnownName{"\xE6\x99\x82\xE5\x88\xBB"},
                                   KnownName{"microseconds", 1000},
                                   KnownName{"nanoseconds", 1},
                                   KnownName{"sampletimefine"}};  // Xsens: 0.1 ms from MT Manager, 1 us from DOTs

// Units as names, and what is a clock elsewhere: time only where the values are a steady clock.
constexpr std::array kClockNames = {KnownName{"ms", 1000000},
                                    KnownName{"msec", 1000000},
                                    KnownName{"us", 1000},
                                    KnownName{"usec", 1000},
                                    KnownName{"ns", 1},
                                    KnownName{"ts"},
                                    KnownName{"tow", 1000000000},
                                    KnownName{"itow", 1000000},
                                    KnownName{"gpst", 1000000000},
                                    KnownName{"mjd"},
                                    KnownName{"sod", 1000000000},
                                    KnownName{"sow", 1000000000},
                                    KnownName{"utc"},
                                    KnownName{"tick"},
                                    KnownName{"ticks"}};

// Time only where the values are dates or clock times.
constexpr std::array<std::string_view, 8> kDateNames = {"date",    "datum", "fecha", "data",
                                                        "uhrzeit", "heure", "hora",  "clock"};

// Words for units in the languages of spreadsheets, beside those that units have everywhere; their plurals are longer.
constexpr std::array kUnitWords = {KnownName{"tag", 86400000000000},  KnownName{"jour", 86400000000000},
                                   KnownName{"dia", 86400000000000},  KnownName{"doy", 86400000000000},
                                   KnownName{"jday", 86400000000000}, KnownName{"hr", 3600000000000},
                                   KnownName{"std", 3600000000000},   KnownName{"stunde", 3600000000000},
                                   KnownName{"heure", 3600000000000}, KnownName{"hora", 3600000000000},
                                   KnownName{"ore", 3600000000000},   KnownName{"min", 60000000000},
                                   KnownName{"minut", 60000000000},   KnownName{"minuto", 60000000000},
                                   KnownName{"sec", 1000000000},      KnownName{"sek", 1000000000},
                                   KnownName{"sekunde", 1000000000},  KnownName{"seconde", 1000000000},
                                   KnownName{"seg", 1000000000},      KnownName{"segundo", 1000000000},
                                   KnownName{"millisecond", 1000000}, KnownName{"millisekunde", 1000000},
                                   KnownName{"milli", 1000000},       KnownName{"msec", 1000000},
                                   KnownName{"msek", 1000000},        KnownName{"microsecond", 1000},
                                   KnownName{"mikrosekunde", 1000},   KnownName{"usec", 1000},
                                   KnownName{"nanosecond", 1},        KnownName{"nano", 1}};

constexpr std::array<std::string_view, 14> kDevices = {"device", "dev",    "sensor",    "imu",   "hardware",
                                                       "hw",     "sample", "acc",       "accel", "accelerometer",
                                                       "gyr",    "gyro",   "gyroscope", "mag"};
constexpr std::array<std::string_view, 11> kHosts = {"host",    "pc",       "ros",     "system", "sys", "recv",
                                                     "receive", "received", "arrival", "log",    "unix"};
constexpr std::array<std::string_view, 3> kTimes = {"time", "timestamp", "stamp"};

// "imu_time", "time_host" or "arrival timestamp": one of `words` beside a word for time.
template <std::size_t N>
bool time_of(std::string_view name, const std::array<std::string_view, N>& words) {
  const std::size_t between = name.find_first_of("_ .-");
  if (between == std::string_view::npos) return false;
  const std::string_view first = name.substr(0, between), second = name.substr(between + 1);
  return (among(words, first) && among(kTimes, second)) || (among(kTimes, first) && among(words, second));
}

// "field.header.stamp", "/imu/header/stamp": stamps that a driver wrote.
bool header_stamp(std::string_view name) {
  for (const std::string_view part : {"secs", "sec"})
    if (name.ends_with(part) && name.size() > part.size() + 1) name.remove_suffix(part.size() + 1);
  static constexpr std::array<std::string_view, 4> kEnds = {"header.stamp", "header/stamp", "header_stamp",
                                                            "header:stamp"};
  return std::any_of(kEnds.begin(), kEnds.end(), [&](std::string_view end) { return name.ends_with(end); });
}

// "hours", "in Stunden", "sek.": a word for a unit of time, else 0. Other units are known by their capitals.
std::int64_t unit_of_word(std::string_view text) {
  const std::string lower = ascii_lower(text);
  std::string_view word = trimmed(lower);
  if (word.starts_with("in ")) word = trimmed(word.substr(3));
  if (word.ends_with('.')) word.remove_suffix(1);
  for (const std::string_view one : {trimmed(text), word})
    if (const auto known = find_unit(one))
      return known->quantity == Quantity::time ? clamped_whole<std::int64_t>(std::round(known->to_si * 1e9)) : 0;
  static constexpr std::array<std::string_view, 5> kPlurals = {"s", "n", "en", "e", "es"};
  for (const KnownName& unit : kUnitWords)
    if (word.starts_with(unit.name)) {
      const std::string_view rest = word.substr(unit.name.size());
      if (rest.empty() ? word != "tag" : among(kPlurals, rest)) return unit.unit_ns;
    }
  return 0;
}

// "elapsed hours", "zeit in stunden", "t/h", "hours since start": a unit behind a word for time, or alone.
std::optional<TimeName> name_with_unit(std::string words) {
  constexpr std::int64_t kMinute = 60000000000;
  std::replace(words.begin(), words.end(), '/', ' ');
  const std::string_view all = words;
  const std::size_t last = all.rfind(' ') + 1;  // npos + 1 is 0
  TimeName out;
  if (const std::size_t since = all.find(" since "); since != std::string_view::npos) {
    out.unit_ns = unit_of_word(all.substr(0, since));
    return out.unit_ns != 0 ? std::optional(out) : std::nullopt;
  }
  // "seconds of day", "gps sec of week": what begins again, where it is a steady clock.
  if (const std::size_t of = all.find(" of "); of != std::string_view::npos) {
    out.unit_ns = unit_of_word(all.substr(all.substr(0, of).rfind(' ') + 1, of - all.substr(0, of).rfind(' ') - 1));
    out.letter = true;
    return out.unit_ns != 0 && out.unit_ns <= kMinute ? std::optional(out) : std::nullopt;
  }
  const std::string_view word = all.substr(last);
  std::string_view before = trimmed(all.substr(0, last));
  for (const std::string_view link : {" in", ","})
    if (before.ends_with(link)) before.remove_suffix(link.size());
  static constexpr std::array<std::string_view, 8> kOthers = {"t",           "run",       "runtime", "run time",
                                                              "since start", "test time", "decimal", "fractional"};
  const bool time = among(kOthers, before) ||
                    std::any_of(kTimeNames.begin(), kTimeNames.end(),
                                [&](const KnownName& known) { return known.name == before && known.unit_ns == 0; });
  out.letter = !time || before == "t";
  out.unit_ns = time && word == "d" ? 1440 * kMinute : unit_of_word(word);
  // Alone it is in the plural.
  const bool alone = before.empty() && word.size() > 2 && word != "min" &&
                     (word.ends_with('s') || word.ends_with('n') || word == "tage" || out.unit_ns < kMinute);
  return out.unit_ns != 0 && (time || alone) ? std::optional(out) : std::nullopt;
}

}  // namespace

std::optional<TimeName> time_name(std::string_view stem) {
  std::string spelled(stem);
  for (const std::string_view unit : {"Ms", "Us", "Ns", "Sec"})  // "epochMs"
    if (stem.ends_with(unit) && stem.size() > unit.size() && ascii_lower(stem)[stem.size() - unit.size() - 1] >= 'a')
      spelled.insert(stem.size() - unit.size(), "_");
  const std::string lower = ascii_lower(spelled);
  std::string_view name = lower;
  while (name.size() > 1 && (name[0] == '_' || name[0] == '%' || name[0] == '#' || name[0] == ' '))
    name.remove_prefix(1);
  if (name.ends_with("()")) name.remove_suffix(2);  // millis()
  if (name.size() > 1 && name.ends_with('.')) name.remove_suffix(1);
  TimeName out;
  if (name == "sampletimefine" || name == "sampletime" || time_of(name, kDevices) || header_stamp(name))
    out.clock = Clock::device;
  else if (time_of(name, kHosts))
    out.clock = Clock::host;
  std::string words(name);
  std::replace(words.begin(), words.end(), '_', ' ');
  for (const KnownName& known : kTimeNames)
    if (known.name == words) {
      out.unit_ns = known.unit_ns;
      return out;
    }
  for (const KnownName& known : kClockNames)
    if (known.name == name) {
      out.unit_ns = known.unit_ns;
      out.letter = true;
      return out;
    }
  if (const auto with_unit = name_with_unit(words)) return with_unit;
  out.letter = name == "t";
  out.date = among(kDateNames, name);
  const bool said = out.letter || out.date || out.clock != Clock::unknown || name.starts_with("timestamp_") ||
                    name.starts_with("timestamp ") || name.starts_with("date time,") ||
                    name.starts_with("time since start");
  return said ? std::optional(out) : std::nullopt;
}

std::int64_t unit_behind(const ColumnLabel& column) {
  const auto [stem, unit] = name_and_unit(column.name);
  if (stem.ends_with("_of") || stem.ends_with(" of"))  // "seconds_of_day" counts seconds
    return unit_of_word(std::string_view(stem).substr(0, stem.size() - 3));
  for (const std::string& text : {column.unit, unit}) {
    if (const std::int64_t ns = unit_of_word(text); ns != 0) return ns;
    if ((text == "d" || text == "m") && time_name(stem)) return text == "d" ? 86400000000000 : 60000000000;
  }
  return 0;
}

std::int64_t unit_said(const ColumnLabel& column) {
  if (const std::int64_t ns = unit_behind(column); ns != 0) return ns;
  const std::string stem = name_and_unit(column.name).first;
  const auto known = time_name(stem);
  return known && (known->unit_ns != 0 || known->date) ? known->unit_ns
                                                       : unit_of_word(stem);  // "hora" is a time of day
}

}  // namespace libchar

#include "libchar/log/time/time_names.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

struct KnownName {
  std::string_view name;
  std::int64_t unit_ns = 0;  // 0 = not said by the name
};

constexpr std::array kTimeNames = {
    KnownName{"time"},
    KnownName{"timestamp"},
    KnownName{"time stamp"},
    KnownName{"timestamps"},
    KnownName{"stamp"},
    KnownName{"times"},
    KnownName{"elapsed"},
    KnownName{"elapsed time"},
    KnownName{"elapsed_time"},
    KnownName{"time elapsed"},
    KnownName{"time_elapsed"},
    KnownName{"time since start"},
    KnownName{"relative time"},
    KnownName{"uptime"},
    KnownName{"time_stamp"},
    KnownName{"host_time"},
    KnownName{"sample_time"},
    KnownName{"sampletime"},
    KnownName{"datetime"},
    KnownName{"date time"},
    KnownName{"date/time"},
    KnownName{"date_time"},
    KnownName{"gps_time"},
    KnownName{"unix_time"},
    KnownName{"unixtime"},
    KnownName{"epoch"},
    KnownName{"epoch_time"},
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
    KnownName{"seconds_elapsed", 1000000000},
    KnownName{"elapsed_seconds", 1000000000},
    KnownName{"sec", 1000000000},
    KnownName{"secs", 1000000000},
    KnownName{"x_value", 1000000000},  // LabVIEW measurement files
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
                                    KnownName{"mjd"},
                                    KnownName{"utc"},
                                    KnownName{"tick"},
                                    KnownName{"ticks"}};

// Time only where the values are dates or clock times.
constexpr std::array<std::string_view, 8> kDateNames = {
    "date", "datum", "fecha", "data", "uhrzeit", "heure", "hora", "clock"};

constexpr std::array<std::string_view, 14> kDevices = {"device",
                                                       "dev",
                                                       "sensor",
                                                       "imu",
                                                       "hardware",
                                                       "hw",
                                                       "sample",
                                                       "acc",
                                                       "accel",
                                                       "accelerometer",
                                                       "gyr",
                                                       "gyro",
                                                       "gyroscope",
                                                       "mag"};
constexpr std::array<std::string_view, 11> kHosts = {
    "host", "pc", "ros", "system", "sys", "recv", "receive", "received", "arrival", "log", "unix"};
constexpr std::array<std::string_view, 3> kTimes = {"time", "timestamp", "stamp"};

template <std::size_t N>
bool among(const std::array<std::string_view, N>& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

// "imu_time", "time_host" or "arrival timestamp": one of `words` beside a word for time.
template <std::size_t N>
bool time_of(std::string_view name, const std::array<std::string_view, N>& words) {
  const std::size_t between = name.find_first_of("_ .-");
  if (between == std::string_view::npos) return false;
  const std::string_view first = name.substr(0, between), second = name.substr(between + 1);
  return (among(words, first) && among(kTimes, second)) ||
         (among(kTimes, first) && among(words, second));
}

// "field.header.stamp", "/imu/header/stamp": stamps that a driver wrote.
bool header_stamp(std::string_view name) {
  for (const std::string_view part : {"secs", "sec"})
    if (name.ends_with(part) && name.size() > part.size() + 1) name.remove_suffix(part.size() + 1);
  static constexpr std::array<std::string_view, 4> kEnds = {
      "header.stamp", "header/stamp", "header_stamp", "header:stamp"};
  return std::any_of(
      kEnds.begin(), kEnds.end(), [&](std::string_view end) { return name.ends_with(end); });
}

}  // namespace

std::optional<TimeName> time_name(std::string_view stem) {
  const std::string lower = ascii_lower(stem);
  std::string_view name = lower;
  while (name.size() > 1 && (name[0] == '_' || name[0] == '%' || name[0] == '#' || name[0] == ' '))
    name.remove_prefix(1);
  if (name.ends_with("()")) name.remove_suffix(2);  // millis()
  TimeName out;
  if (name == "sampletimefine" || name == "sampletime" || time_of(name, kDevices) ||
      header_stamp(name))
    out.clock = Clock::device;
  else if (time_of(name, kHosts))
    out.clock = Clock::host;
  for (const KnownName& known : kTimeNames)
    if (known.name == name) {
      out.unit_ns = known.unit_ns;
      return out;
    }
  for (const KnownName& known : kClockNames)
    if (known.name == name) {
      out.unit_ns = known.unit_ns;
      out.letter = true;
      return out;
    }
  out.letter = name == "t";
  out.date = among(kDateNames, name);
  const bool said = out.letter || out.date || out.clock != Clock::unknown ||
                    name.starts_with("timestamp_") || name.starts_with("timestamp ") ||
                    name.starts_with("date time,") || name.starts_with("time since start");
  return said ? std::optional(out) : std::nullopt;
}

}  // namespace libchar

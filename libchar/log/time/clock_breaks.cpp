#include "libchar/log/time/clock_breaks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/log/time/recent_stamps.hpp"

namespace libchar {
namespace {

constexpr std::int64_t kHour = 3600 * kNsInSecond, kDay = 24 * kHour;

/// What a clock counts before it begins again.
struct ClockRange {
  double ns = 0;
  int bits = 0;              // of a counter, 0 for a part of the calendar
  const char* what = "";     // it counts
  double most_steps = 1000;  // between the two rows: a short range may be left by a restart as well
};

std::vector<ClockRange> ranges_of(const TimeBase& clock) {
  std::vector<ClockRange> out;
  constexpr double kShort = 20, kLong = 1000;  // logs end, and begin again, after 16.8 and 65.5 s as well
  for (const int bits : {16, 24, 32}) {
    if (clock.unit_ns < kNsInSecond)
      out.push_back({std::ldexp(static_cast<double>(clock.unit_ns), bits), bits, "", bits < 32 ? kShort : kLong});
    for (const double unit : {1e3, 1e6})
      if (unit != static_cast<double>(clock.unit_ns))
        out.push_back({std::ldexp(unit, bits), bits, "", bits < 32 ? 2.5 : 20});
  }
  for (const ClockRange& part :
       {ClockRange{60e9, 0, "seconds of a minute", 2.5}, ClockRange{3600e9, 0, "seconds of an hour", 2.5},
        ClockRange{43200e9, 0, "hours of half a day", 2.5}, ClockRange{86400e9, 0, "seconds of a day", 20},
        ClockRange{604800e9, 0, "seconds of a week", 20}})
    out.push_back(part);
  return out;
}

/// The first row stands further in front of the second than all others of the log reach, as the first ones let expect.
bool is_lone(std::span<const std::int64_t> stamps, std::uint64_t rows) {
  constexpr std::size_t kFewest = 16;
  constexpr double kFewestSteps = 64, kSure = 1.1;  // of a number of rows that is an estimate
  if (stamps.size() <= kFewest || rows == 0) return false;
  const double step = step_between(stamps[0], stamps[1]);
  const double mean = step_between(stamps[1], stamps.back()) / static_cast<double>(stamps.size() - 2);
  return mean > 0 && step > mean * std::max(kFewestSteps, kSure * static_cast<double>(rows));
}

/// From 0 on, or about it as signed numbers are.
bool holds(const ClockRange& range, std::int64_t before_ns, std::int64_t stamp_ns) {
  const auto before = static_cast<double>(before_ns), stamp = static_cast<double>(stamp_ns);
  if (stamp >= 0) return before < range.ns;
  return range.bits > 0 && stamp >= -0.5 * range.ns && before < 0.5 * range.ns;
}

}  // namespace

std::optional<ClockWrap> find_wrap(std::int64_t before_ns, std::int64_t stamp_ns, const TimeBase& clock,
                                   double interval_ns) {
  const double back = step_between(before_ns, stamp_ns);
  if (clock.local) {
    const double step = back + static_cast<double>(kHour);
    if (step > 0 && step < 2.5 * interval_ns && back < 0)
      return ClockWrap{kHour, "an hour is repeated, as at the end of summer time", true};
  }
  // Of several the one with the shortest step.
  std::optional<ClockWrap> found;
  double shortest = std::numeric_limits<double>::infinity();
  for (const ClockRange& range : ranges_of(clock)) {
    if (range.ns > 4e18 || !holds(range, before_ns, stamp_ns)) continue;
    const double step = back + range.ns;
    if (!(step > 0 && step < 0.5 * range.ns && step < range.most_steps * interval_ns) || step >= shortest) continue;
    shortest = step;
    found = ClockWrap{clamped_whole<std::int64_t>(std::round(range.ns)),
                      range.bits > 0 ? fmt::format("the {}-bit clock ran over", range.bits)
                                     : fmt::format("the {} begin again", range.what),
                      false};
  }
  return found;
}

std::int64_t skipped_hour(std::int64_t before_ns, std::int64_t stamp_ns, const TimeBase& clock, double interval_ns) {
  if (!clock.local || interval_ns > 0.5 * static_cast<double>(kHour)) return 0;
  const double step = static_cast<double>(stamp_ns - before_ns - kHour);
  const std::int64_t day = stamp_ns / kDay, of_day = stamp_ns % kDay;
  const bool sunday = day > 0 && (day + 4) % 7 == 0;  // 1970-01-01 was a Thursday
  const bool at_night = of_day >= kHour && of_day < 4 * kHour && static_cast<double>(of_day % kHour) < 2 * interval_ns;
  return sunday && at_night && std::fabs(step - interval_ns) < 0.5 * interval_ns ? kHour : 0;
}

std::size_t wild_start(std::span<const std::int64_t> stamps, const TimeBase& clock, std::uint64_t rows) {
  constexpr std::size_t kMost = 64, kTimes = 4;
  constexpr double kFar = 1e8, kFromZero = 1e3;  // steps ahead: no pause is as long, nor one behind a first zero
  std::size_t wild = is_lone(stamps, rows) ? 1 : 0;
  for (std::size_t i = 1; i <= kMost && i + std::max<std::size_t>(kTimes * i, 4) <= stamps.size(); ++i) {
    std::vector<double> steps;
    bool rise = true;
    for (std::size_t k = i + 1; k < i + kTimes * i && rise; ++k) {
      steps.push_back(step_between(stamps[k - 1], stamps[k]));
      rise = steps.back() > 0;
    }
    if (!rise) continue;
    const double usual = median_in_place(steps, Middle::lower);
    const double step = step_between(stamps[i - 1], stamps[i]);
    const double far = i == 1 && stamps[0] == 0 ? kFromZero : kFar;
    if (step > far * usual || (step < -10 * usual && !find_wrap(stamps[i - 1], stamps[i], clock, usual))) wild = i;
  }
  return wild;
}

}  // namespace libchar

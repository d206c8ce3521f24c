// What the grid learns of its first rows, and of those at the beginning of a window: which are its own,
// and the model of their stamps.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/log/time/grid.hpp"

namespace libchar {
namespace {

constexpr std::size_t kEnough = 64;           // rows of a window that may say another interval
constexpr std::size_t kLearn = 1025;          // rows whose stamps decide on dt
constexpr std::size_t kLearnSeconds = 16385;  // where those are whole seconds, with which other clocks beat slowly

bool steps_are_alike(const std::vector<std::int64_t>& stamps, double ns) {
  constexpr double kOff = 0.05, kMost = 0.8;
  double alike = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    alike += std::fabs(step_between(stamps[i - 1], stamps[i]) - ns) <= kOff * ns ? 1 : 0;
  return alike >= kMost * static_cast<double>(stamps.size() - 1);
}

// Rows that keep no clock, at their mean rate; steps far beyond the usual ones are pauses.
StampModel without_clock(const std::vector<std::int64_t>& stamps) {
  constexpr double kPause = 3;  // of the longest but two in a hundred
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i) steps.push_back(step_between(stamps[i - 1], stamps[i]));
  std::sort(steps.begin(), steps.end());
  const double longest = kPause * steps[steps.size() * 98 / 100];
  const auto end = std::upper_bound(steps.begin(), steps.end(), longest);
  const double ns = std::accumulate(steps.begin(), end, 0.0) / static_cast<double>(end - steps.begin());
  return {ns, longest, StampPattern::uneven, ns, ns};
}

}  // namespace

void TimeGrid::leave_out(Pending& item) {
  if (item.own) return;
  item.own = true;
  const CopiedRows::Left copies = clocks_.copies.leave_out(item.block);
  counts_.dropped += copies.count;
  if (copies.count > 0)
    warnings_.add("duplicate_timestamp",
                  "rows that repeat the stamp and all values of the row before: the first is kept",
                  place(item, copies.first), copies.count);
  if (!clocks_.rows.apart()) return;
  const std::size_t blank = leave_out_blank_rows(item.block);
  counts_.dropped += blank;
  if (blank > 0)
    warnings_.add("own_rows",
                  "rows without a value of the channels that are read are left out: these have a clock of their own",
                  "", blank);
}

/// Enough rows are there to learn from.
bool TimeGrid::ready(bool end) {
  if (end && !clocks_.rows.decided()) {
    clocks_.rows.decide_at_end();
    clocks_.copies.decide();
    waiting_ = 0;
    for (Pending& waiting : pending_) {
      leave_out(waiting);
      waiting_ += waiting.block.rows - waiting.done;
    }
  }
  return clocks_.rows.decided() && waiting_ > 0 && (end || waiting_ >= rows_to_learn());
}

std::size_t TimeGrid::rows_to_learn() const {
  std::size_t rows = 0;
  for (const Pending& item : pending_)
    for (std::size_t i = item.done; i < item.block.rows && rows < kLearn; ++i, ++rows)
      if (item.block.time_ns[i] % 1000000000 != 0) return kLearn;
  return kLearnSeconds;
}

/// Of the rows that wait, as far as the window goes.
std::vector<std::int64_t> TimeGrid::first_stamps() {
  std::vector<std::int64_t> stamps;
  const std::size_t most = rows_to_learn();
  for (const Pending& item : pending_)
    for (std::size_t i = item.done; i < item.block.rows && stamps.size() < most; ++i) {
      const std::int64_t stamp = checked(item, i, item.block.time_ns[i]);
      const std::int64_t first = last_.any ? last_.first - last_.wrap : stamps.empty() ? stamp : stamps.front();
      if (stamps.size() > 1 && window_.to_ns != INT64_MAX && stamp - first >= window_.to_ns) return stamps;
      stamps.push_back(stamp);
    }
  return stamps;
}

void TimeGrid::drop_wild_start(const std::vector<std::int64_t>& stamps) {
  const bool whole = waiting_ < rows_to_learn();
  const std::uint64_t rows = whole ? waiting_ : source_.info().rows;
  for (std::size_t left = wild_start(stamps, source_.info().time, rows); left > 0; --left) {
    while (pending_.front().done == pending_.front().block.rows) pending_.pop_front();
    drop_wild(pending_.front(), pending_.front().done);
    ++pending_.front().done;
    ++counts_.dropped;
    --waiting_;
  }
  while (pending_.front().done == pending_.front().block.rows) pending_.pop_front();
}

void TimeGrid::refuse_without_axis(const std::vector<std::int64_t>& stamps) {
  const Pending* item = &pending_.front();
  std::size_t row = item->done + 1;
  if (row >= item->block.rows) {
    item = &pending_[1];
    row = 0;
  }
  const bool fall = std::is_sorted(stamps.rbegin(), stamps.rend()), equal = stamps.front() == stamps.back();
  const std::vector<std::int64_t> turned(stamps.rbegin(), stamps.rend());
  const double ns = fall && !equal ? model_of_stamps(turned, {}).ns : 0;
  fail(*item, row, "E0315",
       fall && equal ? "no time axis: all stamps are equal"
       : fall        ? "the stamps fall from row to row: the newest row is the first"
                     : "no time axis: the stamps never rise",
       std::string(fall && !equal ? "turn the rows round (tac) below the header; " : "") +
           fmt::format("`time_column` none and `rate_hz` {} ignore the stamps",
                       ns > 0 ? shortest(rounded(1e9 / ns, 6)) : "HZ"));
}

// Rows at another rate than those of the longer rest stand in front of the window.
void TimeGrid::leave_out_first_rate(const std::vector<std::int64_t>& stamps) {
  if (const std::size_t rows = at_once_in_front(stamps); rows > 0) {
    const std::int64_t from = stamps[rows] - stamps.front();
    if (from <= window_.from_ns) return;
    window_.from_ns = from;
    window_.other_rate = true;
    warnings_.add("rate_change",
                  fmt::format("the first {} rows come at once, as from a full buffer: they are left out", rows));
    return;
  }
  const auto change = find_rate_change(stamps);
  if (!change || 2 * change->row > static_cast<double>(stamps.size())) return;
  const auto row = clamped_whole<std::size_t>(std::ceil(change->row));
  const std::int64_t from = stamps[row] - stamps.front();
  if (from <= window_.from_ns) return;
  window_.from_ns = from;
  window_.other_rate = true;
  const double seconds = std::round(static_cast<double>(from) * 1e-6) / 1e3;
  warnings_.add(
      "rate_change",
      fmt::format("the sampling rate changes from {} to {} Hz: the first {} s are left out (`to_s` {} reads these)",
                  brief_text(1e9 / change->before_ns, 5), brief_text(1e9 / change->after_ns, 5), shortest(seconds),
                  shortest(seconds)));
}

// Where packets of one stamp lost rows, each row gets an instant of its own, if that is sure or told.
void TimeGrid::spread_lossy_packets(const std::vector<std::int64_t>& stamps) {
  const auto lossy = source_.several_clocks() ? std::nullopt : find_lossy_packets(stamps);
  if (!lossy) return;
  constexpr double kAsTold = 0.01;
  const double hz = 1e9 / lossy->interval_ns(), stated = source_.info().time.rate_hz,
               told = options_.rate_hz.value_or(stated);
  const std::string rate = brief_text(hz, 5);
  if (told > 0 ? std::fabs(told / hz - 1) > kAsTold : !lossy->sure) {
    if (told == 0 && lossy->likely)
      warnings_.add("uneven_sampling",
                    fmt::format("packets of one stamp have fewer rows at times: if rows are lost, {} Hz is the rate of "
                                "the samples (`rate_hz` {} takes what the others lack as missing)",
                                rate, rate));
    return;
  }
  clocks_.packets = PacketRows(*lossy);
  for (Pending& item : pending_) clocks_.packets.spread(item.block.time_ns, item.done);
  warnings_.add(
      "packets",
      fmt::format("packets of {} rows share a stamp, and some lack rows: samples are those of {} Hz, and what "
                  "a packet lacks is taken to be its last rows",
                  lossy->rows, rate));
}

// At the first row, and at the first one of a window that begins later: in front of it the rate may be another.
void TimeGrid::learn() {
  learned_ = true;
  if (!last_.any) {
    drop_wild_start(first_stamps());
    spread_lossy_packets(first_stamps());
  }
  const std::vector<std::int64_t> stamps = caught_up(first_stamps());
  if (!last_.any && !source_.several_clocks()) leave_out_first_rate(stamps);
  const double stated = source_.info().time.rate_hz;
  StampModel found =
      model_of_stamps(stamps, options_.rate_hz || stated == 0 ? options_.rate_hz : std::optional(stated));
  if (!options_.rate_hz && stated == 0 && !source_.several_clocks()) look_behind(stamps, found);
  const bool begins = window_.from_ns <= 0 || last_.any;
  const bool other = stamps.size() >= kEnough && std::fabs(found.ns - step_.ns) > 0.01 * step_.ns;
  if (!last_.any || other) step_ = Step(found);
  step_.steady = steps_are_alike(stamps, step_.ns);
  if (other || window_.other_rate || watch_.longest().rows > 0 || sketch_.rate_change()) {  // of another rate
    sketch_ = {};
    recent_.rows.clear();
    watch_ = {};
  }
  if (step_.ns == 0 && stamps.size() > 1) refuse_without_axis(stamps);
  if (!begins) return;
  window_.begun = true;
  say_pattern(step_.model);
  begin();
}

// Stamps that scatter too far for their steps to tell: the interval is that of the clock behind them, if there is one.
void TimeGrid::look_behind(const std::vector<std::int64_t>& stamps, StampModel& found) {
  behind_ = {};
  constexpr std::size_t kEqual = 10;  // of so many, one step at most: more tell of a coarse clock, or of packets
  std::size_t equal = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i) equal += stamps[i] == stamps[i - 1] ? 1 : 0;
  const bool rarely = equal > 0 && kEqual * equal < stamps.size() && found.pattern != StampPattern::packets;
  if (found.pattern != StampPattern::steps && found.pattern != StampPattern::uneven && !rarely) return;
  behind_ = clock_behind(stamps, found.ns);
  constexpr double kAsBehind = 5e-4;
  const bool even = !behind_.ns || std::fabs(*behind_.ns - found.ns) < kAsBehind * found.ns;
  if (found.pattern == StampPattern::uneven && even) behind_ = {};  // turns of unlike steps, all told
  if (behind_.needed && !behind_.ns) found = without_clock(stamps);
  if (behind_.ns) found = {*behind_.ns, 1.5 * *behind_.ns, StampPattern::steps, *behind_.ns, *behind_.ns};
}

void TimeGrid::say_pattern(const StampModel& found) {
  const double step_hz = 1e9 / found.step_ns, span_hz = 1e9 / found.span_ns;
  switch (found.pattern) {
    case StampPattern::steps:
      return;
    case StampPattern::equal:
      warnings_.add("coarse_stamps",
                    "the clock is too coarse to tell rows apart (many equal stamps): rows are kept and spaced evenly");
      return;
    case StampPattern::coarse:
      warnings_.add("coarse_stamps",
                    fmt::format("the stamps are rounded to a coarse clock and keep to one line: rows are spaced "
                                "evenly (`rate_hz` {} takes the longer steps as gaps)",
                                shortest(rounded(step_hz, 5))));
      return;
    case StampPattern::packets:
      warnings_.add("packets", fmt::format("the stamps are those of packets: rows are spaced evenly at {}, rows "
                                           "over time (`rate_hz` {}, the rate inside a packet, takes the rest as gaps)",
                                           detail::frequency_text(span_hz, 5), shortest(rounded(step_hz, 5))));
      return;
    case StampPattern::uneven:
      if (behind_.needed && !behind_.ns) {
        warnings_.add("uneven_sampling",
                      "the rows keep no even clock: the rate is their mean, values are taken as if they were even, "
                      "and frequencies and averaging times are off by that");
        return;
      }
      warnings_.add("uneven_stamps", fmt::format("the stamps take turns in steps of unlike length and keep to one "
                                                 "line: rows are spaced evenly at {}, rows over time",
                                                 detail::frequency_text(span_hz, 5)));
      return;
    case StampPattern::disputed:
      if (source_.several_clocks()) return;
      fail(pending_.front(), 0, "E0324",
           fmt::format("two sampling rates: most stamps follow each other at {}, rows over time give {}, and "
                       "gaps do not explain it",
                       detail::frequency_text(step_hz, 5), detail::frequency_text(span_hz, 5)),
           fmt::format("`rate_hz` {} or `rate_hz` {} decides", shortest(rounded(step_hz, 5)),
                       shortest(rounded(span_hz, 5))));
  }
}

}  // namespace libchar

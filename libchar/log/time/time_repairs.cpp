// What becomes of a row whose stamp is not one regular step behind the last: doubled, late, ahead,
// backward, behind a rollover, or the first of another rate.

#include "libchar/log/time/time_repairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libchar/core/error.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/log/time/grid.hpp"

namespace libchar {
namespace {

constexpr std::int64_t kSecond = 1000000000;  // ns; a counter's unit is below it
constexpr double kLargestGap = 1e8;           // grid points in one gap
constexpr std::uint64_t kBackward =
    64;                               // backward rows in a row before the clock is called restarted
constexpr double kWildSteps = 10000;  // steps ahead of its followers that make a single stamp wild
constexpr int kRateRun = 8;           // equal odd steps in a row that make a change of rate

/// Of an interval far below a nanosecond there may be more steps than 64 bits count.
std::int64_t whole_steps(double steps) {
  return static_cast<std::int64_t>(std::llround(std::clamp(steps, -9e18, 9e18)));
}

}  // namespace

GridStretch gap_in_window(
    std::int64_t gap, double before_ns, double dt_ns, std::int64_t from_ns, std::int64_t to_ns) {
  GridStretch inside{1, gap};
  if (before_ns < static_cast<double>(from_ns))
    inside.first = std::max<std::int64_t>(
        1, whole_steps(std::ceil((static_cast<double>(from_ns) - before_ns) / dt_ns)));
  if (to_ns != INT64_MAX)
    inside.last = std::min<std::int64_t>(
        gap, whole_steps(std::ceil((static_cast<double>(to_ns) - before_ns) / dt_ns)) - 1);
  return inside;
}

std::optional<Rollover> find_rollover(std::int64_t before_ns,
                                      std::int64_t stamp_ns,
                                      std::int64_t unit_ns,
                                      double dt_ns) {
  for (const int bits : {16, 32}) {
    const double range = std::ldexp(static_cast<double>(unit_ns), bits);
    if (range > 4e18 || stamp_ns < 0 || before_ns < 0 || static_cast<double>(before_ns) >= range)
      continue;
    const double step = static_cast<double>(stamp_ns - before_ns) + range;
    if (step > 0 && step < 0.5 * range && step < 1000 * dt_ns)
      return Rollover{bits, static_cast<std::int64_t>(range)};
  }
  return std::nullopt;
}

std::int64_t common_lag(std::vector<double> lags) {
  const double own = lags.front();
  const std::size_t quarter = lags.size() / 4;
  std::nth_element(lags.begin(), lags.begin() + static_cast<std::ptrdiff_t>(quarter), lags.end());
  return whole_steps(std::min(own, lags[quarter]));
}

std::string TimeGrid::place(const Pending& front, std::size_t row) const {
  return source_.place(front.block, row, front.rows_before);
}

void TimeGrid::fail(const Pending& front,
                    std::size_t row,
                    std::string code,
                    std::string what,
                    std::string hint) const {
  throw Error({ErrorKind::input,
               std::move(code),
               source_.where(front.block, row, front.rows_before),
               std::move(what),
               "",
               std::move(hint)});
}

std::int64_t TimeGrid::checked(const Pending& front, std::size_t row, std::int64_t stamp) const {
  if (stamp >= kMostNs || stamp <= -kMostNs)
    fail(front,
         row,
         "E0314",
         fmt::format("a time stamp of {} s; those within 146 years (2^62 ns) of zero are read",
                     shortest(static_cast<double>(stamp) * 1e-9)),
         "is the time unit right? `time_unit` says it");
  if (last_.any && (stamp - last_.first > kMostNs || stamp - last_.first < -kMostNs))
    fail(front,
         row,
         "E0316",
         fmt::format(
             "wild time stamp: {} s away from the first",
             shortest(static_cast<double>(stamp) * 1e-9 - static_cast<double>(last_.first) * 1e-9)),
         "remove the row, or read with `time_column` none and `rate_hz` HZ");
  return stamp;
}

// A row whose stamp is not one regular step behind the last one.
TimeGrid::Verdict TimeGrid::decide(const Pending& front,
                                   std::size_t row,
                                   std::int64_t& stamp,
                                   std::size_t ahead) {
  if (!last_.any) {
    last_.first = stamp;
    return Verdict::keep;
  }
  const std::int64_t step = stamp - last_.stamp;
  if (step == 0) {
    if (stamp < last_.as_read) return backward(front, row, stamp);
    if (step_.coarse) return Verdict::keep;
    warnings_.add("duplicate_timestamp",
                  "rows with the stamp of the row before: the first is kept",
                  place(front, row));
    return Verdict::drop;
  }
  if (step < 0) return backward(front, row, stamp);
  watch_rate(front, row, static_cast<double>(step) / step_.ns);
  const std::int64_t gap = lag(front, row, stamp, ahead);
  if (gap > 0)
    pass_gap(front, row, step, gap);
  else
    place_late_row(front, row, step, stamp);
  return Verdict::keep;
}

// Late, but the rows behind it are not: its stamp is wrong, the row has its place.
void TimeGrid::place_late_row(const Pending& front,
                              std::size_t row,
                              std::int64_t step,
                              std::int64_t& stamp) {
  if (static_cast<double>(step) > kWildSteps * step_.ns)
    fail(front,
         row,
         "E0316",
         fmt::format("wild time stamp: {} s ahead of the rows around it",
                     shortest(static_cast<double>(step) * 1e-9)),
         "remove the row, or read with `time_column` none and `rate_hz` HZ");
  warnings_.add("late_stamp",
                "stamps far ahead of the rows behind them: the rows are placed on the grid",
                place(front, row));
  stamp = last_.stamp + static_cast<std::int64_t>(std::llround(step_.ns));
}

// Grid points before the window's start are passed over.
void TimeGrid::pass_gap(const Pending& front,
                        std::size_t row,
                        std::int64_t step,
                        std::int64_t gap) {
  if (static_cast<double>(gap) > kLargestGap)
    fail(front,
         row,
         "E0316",
         fmt::format("wild time stamp: {} s after the row before ({} missing samples)",
                     shortest(static_cast<double>(step) * 1e-9),
                     gap),
         "remove the row, `from_s` and `to_s` choose a stretch, `time_column` none and `rate_hz` "
         "HZ ignore "
         "the stamps");
  warnings_.add("gap", "gaps in the stamps: the missing samples stay missing", place(front, row));
  const GridStretch inside = gap_in_window(gap,
                                           static_cast<double>(last_.stamp - last_.first),
                                           step_.ns,
                                           window_.from_ns,
                                           window_.to_ns);
  if (inside.count() > 0 && !start_ns_)
    start_ns_ = last_.stamp + static_cast<std::int64_t>(
                                  std::llround(static_cast<double>(inside.first) * step_.ns));
  leave_missing(inside.count(), gap);
}

void TimeGrid::leave_missing(std::uint64_t samples, std::int64_t steps) {
  ++counts_.gaps;
  counts_.missing += samples;
  output_.missing(samples);
  last_.index += steps;
}

// Counters of 16 or 32 bits (in the stamps' own unit) that ran over go on; other steps back drop
// the row.
TimeGrid::Verdict TimeGrid::backward(const Pending& front, std::size_t row, std::int64_t& stamp) {
  const std::int64_t unit_ns = source_.info().time.unit_ns;
  if (unit_ns < kSecond) {
    if (const auto rollover =
            find_rollover(last_.stamp - last_.wrap, stamp - last_.wrap, unit_ns, step_.ns)) {
      unwrap(front, row, *rollover, stamp);
      return Verdict::keep;
    }
  }
  if (backward_.in_a_row == 0) backward_.first = source_.where(front.block, row, front.rows_before);
  if (++backward_.in_a_row >= kBackward)
    throw Error(
        {ErrorKind::input,
         "E0317",
         backward_.first,
         fmt::format("the time steps back here and {} rows do not catch up (concatenated "
                     "logs, or a wild stamp before?)",
                     kBackward),
         "",
         "split the file there, `to_s` ends before it, `time_column` none and `rate_hz` HZ ignore "
         "the stamps"});
  warnings_.add("backward_timestamp",
                "rows whose stamp lies before that of the row before: dropped",
                place(front, row));
  return Verdict::drop;
}

void TimeGrid::unwrap(const Pending& front,
                      std::size_t row,
                      const Rollover& rollover,
                      std::int64_t& stamp) {
  last_.wrap += rollover.range_ns;
  stamp = checked(front, row, stamp + rollover.range_ns);
  warnings_.add("clock_rollover",
                fmt::format("the {}-bit clock ran over: unwrapped", rollover.bits),
                place(front, row));
  if (stamp - last_.stamp <= step_.longest) return;
  const std::int64_t late =
      static_cast<std::int64_t>(std::llround(static_cast<double>(stamp - last_.stamp) / step_.ns)) -
      1;
  if (late > 0) leave_missing(static_cast<std::uint64_t>(late), late);
}

// Missing grid points before this row: how much later than expected it and the rows behind it are.
std::int64_t TimeGrid::lag(const Pending& front,
                           std::size_t row,
                           std::int64_t stamp,
                           std::size_t ahead) const {
  const auto late = [&](std::int64_t t, std::size_t j) {
    return static_cast<double>(t - last_.stamp) / step_.ns - static_cast<double>(j + 1);
  };
  std::vector<double> lags{late(stamp, 0)};
  std::size_t item = 0, i = row;
  const Pending* at = &front;
  for (std::size_t j = 1; j < std::min(ahead, kRowsAhead); ++j) {
    if (++i >= at->block.rows) {
      if (++item >= pending_.size()) break;
      at = &pending_[item];
      i = 0;
    }
    std::int64_t t = 0, unused = 0;
    // Rows ahead are not checked yet.
    if (__builtin_add_overflow(at->block.time_ns[i], last_.wrap, &t) ||
        __builtin_sub_overflow(t, last_.stamp, &unused) || t <= last_.stamp)
      continue;
    lags.push_back(late(t, j));
  }
  return common_lag(std::move(lags));
}

// The same odd step many times in a row is another sampling rate, not gaps.
void TimeGrid::watch_rate(const Pending& front, std::size_t row, double ratio) {
  const bool odd = ratio > 1.25 || ratio < 0.75;
  if (!odd) {
    odd_.times = 0;
    odd_.ratio = 1;
    return;
  }
  if (odd_.times == 0 || std::fabs(ratio - odd_.ratio) > 0.1 * odd_.ratio) {
    odd_.times = 0;
    odd_.ratio = ratio;
    // The last row at the old distance.
    odd_.place = row > 0 ? place(front, row - 1) : end_of_block_;
  }
  if (++odd_.times != kRateRun) return;
  warnings_.add("rate_change",
                fmt::format("the sampling rate changes ({} to {} Hz): the grid keeps the first",
                            brief_text(1e9 / step_.ns, 6),
                            brief_text(1e9 / (step_.ns * ratio), 6)),
                odd_.place);
}

}  // namespace libchar

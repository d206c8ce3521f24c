// What becomes of a row whose stamp is not one regular step behind the last: doubled, late, ahead,
// backward, behind a rollover, or the first of another rate.

#include "libchar/log/time/time_repairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/time/grid.hpp"

namespace libchar {
namespace {

constexpr double kLargestGap = 1e8;      // grid points in one gap
constexpr double kLongGap = 64;          // beyond it the rate is too little known to count them
constexpr std::uint64_t kBackward = 64;  // backward rows in a row before the clock is called restarted
constexpr double kWildSteps = 10000;     // steps ahead of its followers that make a single stamp wild
constexpr std::int64_t kWildEnd = 1000;  // steps to the last rows, if that is longer than the log

/// Of an interval far below a nanosecond there may be more steps than 64 bits count.
std::int64_t whole_steps(double steps) {
  return clamped_whole<std::int64_t>(std::round(std::clamp(steps, -9e18, 9e18)));
}

}  // namespace

GridStretch gap_in_window(std::int64_t gap, double before_ns, double dt_ns, std::int64_t from_ns, std::int64_t to_ns) {
  GridStretch inside{1, gap};
  if (before_ns < static_cast<double>(from_ns))
    inside.first =
        std::max<std::int64_t>(1, whole_steps(std::ceil((static_cast<double>(from_ns) - before_ns) / dt_ns)));
  if (to_ns != INT64_MAX)
    inside.last =
        std::min<std::int64_t>(gap, whole_steps(std::ceil((static_cast<double>(to_ns) - before_ns) / dt_ns)) - 1);
  return inside;
}

void Bursts::add(double after_first_ns, double gap_ns) {
  if (gaps_.size() == kMost) return;
  ends_.push_back(after_first_ns);
  gaps_.push_back(gap_ns);
}

double Bursts::period() const {
  constexpr std::size_t kFewest = 2;
  constexpr double kAlike = 0.25, kShare = 0.85, kLong = 0.3, kAwake = 2e9, kSlow = 2.5e9;  // of the usual one; ns
  /// The usual one of lengths that are alike, else 0.
  const auto usual_of = [&](std::vector<double> lengths) {
    const double usual = lengths.empty() ? 0 : median_in_place(lengths, Middle::lower);
    const auto alike = static_cast<double>(std::count_if(
        lengths.begin(), lengths.end(), [&](double one) { return std::fabs(one - usual) <= kAlike * usual; }));
    return alike >= kShare * static_cast<double>(lengths.size()) ? usual : 0;
  };
  const double longest = gaps_.empty() ? 0 : *std::max_element(gaps_.begin(), gaps_.end());
  std::vector<double> gaps, apart, awake;
  double before = 0;
  for (std::size_t i = 0; i < gaps_.size(); ++i) {
    if (gaps_[i] < kLong * longest) continue;  // within a burst
    if (!gaps.empty()) {
      apart.push_back(ends_[i] - before);
      awake.push_back(apart.back() - gaps.back());
    }
    gaps.push_back(gaps_[i]);
    before = ends_[i];
  }
  if (gaps.size() < kFewest || usual_of(gaps) == 0) return 0;
  const double period = usual_of(apart);
  return period > kSlow && median_in_place(awake, Middle::lower) < kAwake ? period : 0;
}

bool OddRun::whole() const {
  constexpr double kMost = 3.5, kOff = 0.12;  // further rows apart, nobody left out the rows between
  return intervals > 1.5 && intervals < kMost &&
         std::fabs(intervals - std::round(intervals)) < std::min(0.03 * intervals, kOff);
}

bool RateWatch::add(std::uint64_t row, double intervals, std::int64_t after_first_ns) {
  constexpr std::uint64_t kApart = 8;  // regular steps that end a run
  if (row > last_row_ + kApart) end();
  const bool first = steps_.empty();
  if (first) {
    first_row_ = row;
    first_ns_ = after_first_ns;
  }
  last_row_ = row;
  last_ns_ = after_first_ns;
  steps_.push_back(intervals);
  if (steps_.size() == kTogether) count(0.25, 0.7);
  return first && run_.rows == 0;
}

void RateWatch::end() {
  if (run_.rows > 0 || steps_.size() >= kShortRun) count(0.1, 1);
  steps_.clear();
  run_ = {};
}

// The steps are those of another rate where so many of them lie so near to the usual one, and near to those before.
void RateWatch::count(double near, double share) {
  if (steps_.empty()) return;
  const auto odd = static_cast<double>(steps_.size());
  std::vector<double> steps = std::exchange(steps_, {});
  const double usual = median_in_place(steps, Middle::lower);
  const auto alike = static_cast<double>(
      std::count_if(steps.begin(), steps.end(), [&](double step) { return std::fabs(step - usual) <= near * usual; }));
  const std::uint64_t rows = last_row_ - first_row_ + 1;
  const bool other = usual > 1.25 || usual < 0.75;
  const bool goes_on = run_.rows == 0 || std::fabs(usual - run_.intervals) <= 0.25 * run_.intervals;
  if (!other || !goes_on || alike < share * odd || odd < 0.7 * static_cast<double>(rows)) {
    run_ = {};
    return;
  }
  if (run_.rows == 0) run_ = {0, usual, first_ns_, 0, place_};
  run_.rows += rows;
  run_.ended_ns = last_ns_;
  // Rows that are only left out say less than any other rate.
  constexpr std::uint64_t kRate = 64;
  const bool surer = !run_.whole() && run_.rows >= kRate && longest_.whole();
  const bool less_sure = run_.whole() && !longest_.whole() && longest_.rows >= kRate;
  if (surer || (run_.rows > longest_.rows && !less_sure)) longest_ = run_;
}

std::string TimeGrid::place(const Pending& front, std::size_t row) const {
  return source_.place(front.block, row, front.rows_before);
}

void TimeGrid::fail(const Pending& front, std::size_t row, std::string code, std::string what, std::string hint) const {
  throw input_error(std::move(code), source_.where(front.block, row, front.rows_before))
      .says(std::move(what))
      .hint(std::move(hint));
}

std::int64_t TimeGrid::checked(const Pending& front, std::size_t row, std::int64_t stamp) const {
  if (stamp >= kMostNs || stamp <= -kMostNs)
    fail(front, row, "E0314",
         fmt::format("a time stamp of {} s; those within 146 years (2^62 ns) of zero are read",
                     shortest(static_cast<double>(stamp) * 1e-9)),
         "is the time unit right? `time_unit` sets it");
  if (last_.any && (stamp - last_.first > kMostNs || stamp - last_.first < -kMostNs))
    fail(front, row, "E0316",
         fmt::format("wild time stamp: {} s away from the first",
                     shortest(static_cast<double>(stamp) * 1e-9 - static_cast<double>(last_.first) * 1e-9)),
         "remove the row, or read with `time_column` none and `rate_hz` HZ");
  return stamp;
}

// A row whose stamp is not one regular step behind the last one.
TimeGrid::Verdict TimeGrid::decide(const Pending& front, std::size_t row, std::int64_t& stamp, std::size_t ahead) {
  if (!last_.any) {
    last_.first = stamp;
    return Verdict::keep;
  }
  std::int64_t step = stamp - last_.stamp;
  if (last_.row < recent_.last_at_once) {
    stamp = place_behind(0);
    return Verdict::keep;
  }
  if (step == 0) {
    if (stamp < last_.as_read) return backward(front, row, stamp);
    if (step_.coarse) return Verdict::keep;
    if (rows_go_on(front, row, ahead)) {
      warnings_.add("held_stamp",
                    "rows repeat the previous stamp, and the rows after them are on time: they keep their place",
                    place(front, row));
      return Verdict::keep;
    }
    warnings_.add("duplicate_timestamp", "rows with the stamp of the row before: the first is kept", place(front, row));
    return Verdict::drop;
  }
  if (step < 0 && step_.even() && static_cast<double>(-step) < step_.model.packets.rows * step_.ns)
    return Verdict::keep;  // an early packet
  if (step < 0) return backward(front, row, stamp);
  if (const std::int64_t hour = skipped_hour(last_.stamp, stamp, source_.info().time, step_.ns)) {
    last_.wrap -= hour;
    stamp -= hour;
    warnings_.add("clock_change", "an hour is skipped, as at the beginning of summer time: no gap", place(front, row));
    return Verdict::keep;
  }
  const bool packets = step_.model.packets.rows > 0;
  const RowsAtOnce behind = packets || step_.coarse ? RowsAtOnce{} : rows_at_once(front, row);
  const std::size_t at_once = behind.count();
  const std::int64_t gap = packets ? packet_lag(front, row, stamp, ahead) : lag(front, row, stamp, ahead, at_once);
  if (packets && gap == 0) return Verdict::keep;
  if (at_once > 0) {
    // At the end of the log no row says how late they are: most of the pause is theirs.
    const bool last_ones = last_.ended && behind.regular < RowsAtOnce::kRegular &&
                           2 * static_cast<double>(at_once) * step_.ns > static_cast<double>(step);
    const std::int64_t missing = last_ones ? 0 : std::max<std::int64_t>(gap, 0), place_here = place_behind(missing);
    if (static_cast<double>(stamp - place_here) > 2 * step_.ns) return hung(front, row, at_once, missing, stamp);
  }
  if (gap == 0 || (!step_.coarse && ahead > 1 && next_lies_before(front, row, stamp))) {
    if (place_late_row(front, row, gap, stamp) == Verdict::drop) return Verdict::drop;
    step = stamp - last_.stamp;
  }
  return gap > 0 ? pass_gap(front, row, step, gap, ahead) : Verdict::keep;
}

TimeGrid::Verdict TimeGrid::drop_wild(const Pending& front, std::size_t row) {
  warnings_.add("wild_stamp", "rows with a stamp far away from those around them: dropped", place(front, row));
  return Verdict::drop;
}

// Late, also behind the gap in front of it, but the rows that follow are not: its stamp is wrong, it has its place.
TimeGrid::Verdict TimeGrid::place_late_row(const Pending& front, std::size_t row, std::int64_t gap,
                                           std::int64_t& stamp) {
  const double passed = static_cast<double>(gap) * step_.ns;
  const double late = static_cast<double>(stamp - last_.stamp) + recent_.rows.last_late(step_.ns) - passed;
  if (late > kWildSteps * step_.ns) return drop_wild(front, row);
  if (late <= 2 * step_.ns) return Verdict::keep;
  warnings_.add("late_stamp", "stamps far ahead of the rows after them: the rows are placed on the grid",
                place(front, row));
  stamp = place_behind(gap);
  return Verdict::keep;
}

/// On the grid, behind so many missing points.
std::int64_t TimeGrid::place_behind(std::int64_t gap) const {
  return last_.stamp + clamped_whole<std::int64_t>(std::round(static_cast<double>(gap + 1) * step_.ns));
}

/// The first of the rows that a logger wrote at once: they are as old as the last of them says.
TimeGrid::Verdict TimeGrid::hung(const Pending& front, std::size_t row, std::size_t at_once, std::int64_t gap,
                                 std::int64_t& stamp) {
  warnings_.add("late_stamp",
                "rows that come at once behind a pause, as of a logger that hung: they are placed on the grid",
                place(front, row));
  recent_.last_at_once = last_.row + 1 + static_cast<std::int64_t>(at_once);
  stamp = place_behind(gap);
  return gap > 0 ? pass_gap(front, row, stamp - last_.stamp, gap, 2 * kRowsAhead) : Verdict::keep;
}

// Grid points before the window's start are passed over. A few last rows, further away than the log
// is long, are no end of a gap.
TimeGrid::Verdict TimeGrid::pass_gap(const Pending& front, std::size_t row, std::int64_t step, std::int64_t gap,
                                     std::size_t left) {
  if (left <= kRowsAhead && gap > kWildEnd && step > last_.stamp - last_.first && counts_.used > kRowsAhead)
    return drop_wild(front, row);
  if (static_cast<double>(gap) > kLargestGap)
    fail(front, row, "E0316",
         fmt::format("wild time stamp: {} s after the row before ({} missing samples)",
                     shortest(static_cast<double>(step) * 1e-9), gap),
         "remove the row, `from_s` and `to_s` choose a stretch, `time_column` none and `rate_hz` HZ ignore the stamps");
  const GridStretch inside =
      gap_in_window(gap, static_cast<double>(last_.stamp - last_.first), step_.ns, window_.from_ns, window_.to_ns);
  if (inside.count() > 0)
    warnings_.add("gap", "gaps in the stamps: the missing samples stay missing", place(front, row));
  if (inside.count() > 0 && !start_ns_)
    start_ns_ = last_.stamp + clamped_whole<std::int64_t>(std::round(static_cast<double>(inside.first) * step_.ns));
  bursts_.add(static_cast<double>(last_.stamp - last_.first), static_cast<double>(gap) * step_.ns);
  leave_missing(inside.count(), gap);
  // The step that is left is a usual one; of packets and the like only the lag says what that is.
  const double left_out = step_.coarse ? static_cast<double>(gap) * step_.ns : static_cast<double>(step) - step_.ns;
  if (static_cast<double>(gap) > kLongGap) sketch_.skip(gap, clamped_whole<std::int64_t>(std::round(left_out)));
  recent_.rows.clear();
  return Verdict::keep;
}

void TimeGrid::leave_missing(std::uint64_t samples, std::int64_t steps) {
  counts_.gaps += samples > 0 ? 1 : 0;
  counts_.missing += samples;
  output_.missing(samples);
  last_.index += steps;
}

// A clock that runs over while rows are missing comes down anywhere, and at the log's first stamp by chance only.
bool TimeGrid::is_restart(std::int64_t stamp, const ClockWrap& wrap) const {
  constexpr double kAsFirst = 1.5, kFollows = 2.5;  // steps
  if (backward_.in_a_row > 0) stamp = backward_.first;
  return step_between(last_.stamp, stamp + wrap.range_ns) > kFollows * step_.ns &&
         std::fabs(step_between(last_.first, stamp - last_.wrap)) <= kAsFirst * step_.ns;
}

// What begins again goes on; other steps back drop the row.
TimeGrid::Verdict TimeGrid::backward(const Pending& front, std::size_t row, std::int64_t& stamp) {
  const auto wrap = find_wrap(last_.stamp - last_.wrap, stamp - last_.wrap, source_.info().time, step_.ns);
  if (wrap && !is_restart(stamp, *wrap)) {
    unwrap(front, row, *wrap, stamp);
    return Verdict::keep;
  }
  if (backward_.in_a_row == 0) backward_.place = source_.where(front.block, row, front.rows_before);
  backward_.add(stamp);
  if (backward_.in_a_row >= kBackward) refuse_backward();
  warnings_.add("backward_timestamp", "rows whose stamp lies before that of the row before: dropped",
                place(front, row));
  return Verdict::drop;
}

namespace {

std::string sorted_hint(const SortedRows& rows) {
  return fmt::format("`where` {} reads one of them, `group_by` {} makes channels of each",
                     shell_word(rows.column + "=" + rows.first), shell_word(rows.column));
}

}  // namespace

void TimeGrid::refuse_backward() const {
  const LogInfo& log = source_.info();
  const auto seconds = [](std::int64_t ns) { return static_cast<double>(ns) / 1e9; };
  const std::string how_far = duration_text(seconds(last_.stamp - backward_.first));
  const bool ordered = backward_.restarted();  // rows in no order have no rate either
  std::string hint = fmt::format("`time_column` none and `rate_hz` {} take the rows one after the other",
                                 ordered && step_.ns > 0 ? shortest(rounded(1e9 / step_.ns, 6)) : "HZ");
  if (!ordered && log.topics.empty())
    hint = fmt::format("sort the rows by {} below the header (sort -g), `where` COLUMN=VALUE reads those of one source",
                       log.time.column.empty() ? "their stamps" : printable(log.time.column));
  if (ordered && last_.stamp > last_.first)
    hint = fmt::format("`to_s` {} reads what is before it, {}", shortest(seconds(last_.stamp - last_.first)), hint);
  const auto sorted = source_.sorted_by();
  if (sorted) hint = sorted_hint(*sorted);
  if (!log.topics.empty() && options_.time_source != "log")
    hint = "`time_source` log takes the time of recording, where the log has it; " + hint;
  throw input_error("E0317", backward_.place)
      .says(ordered ? fmt::format("the time steps back here by {} and goes on from there: {}", how_far,
                                  sorted ? "the rows are sorted by " + printable(sorted->column)
                                  : log.time.unit_ns == kNsInSecond && last_.stamp - backward_.first < kNsInSecond
                                      ? "parts of a second without leading zeros, or two logs in one file"
                                  : 2 * (last_.stamp - backward_.first) < last_.stamp - last_.first
                                      ? "a clock that was set back, or two logs in one file"
                                      : "two logs in one file, or a device that restarted")
                    : fmt::format(
                          "the time steps back here by {}, and the next {} rows are in no order: they are sorted by "
                          "something else, or of several sources, or a wild stamp lies before",
                          how_far, kBackward))
      .hint(hint);
}

// Of stamps that begin again and again those that are left are no axis.
void TimeGrid::refuse_many_backward() const {
  constexpr double kShare = 0.4;
  const Finding* const dropped = warnings_.find("backward_timestamp");
  if (dropped == nullptr || static_cast<double>(dropped->count) <= kShare * static_cast<double>(counts_.rows)) return;
  const auto sorted = source_.sorted_by();
  throw input_error("E0317", source_.info().file)
      .says("the time steps back in {} of {} rows: the stamps begin again and again{}", dropped->count, counts_.rows,
            sorted ? ", with each " + printable(sorted->column) : "")
      .hint(sorted ? sorted_hint(*sorted) : "`time_column` none and `rate_hz` HZ take the rows one after the other");
}

void TimeGrid::unwrap(const Pending& front, std::size_t row, const ClockWrap& wrap, std::int64_t& stamp) {
  last_.wrap += wrap.range_ns;
  stamp = checked(front, row, stamp + wrap.range_ns);
  warnings_.add(wrap.local ? "clock_change" : "clock_rollover", wrap.what + ": unwrapped", place(front, row));
  if (stamp - last_.stamp <= step_.longest) return;
  const std::int64_t late =
      clamped_whole<std::int64_t>(std::round(static_cast<double>(stamp - last_.stamp) / step_.ns)) - 1;
  if (late > 0) leave_missing(static_cast<std::uint64_t>(late), late);
}

/// The row behind this one, in the blocks that wait: one without rows is passed over.
bool TimeGrid::next_row(const Pending*& at, std::size_t& item, std::size_t& row) const {
  for (++row; row >= at->block.rows; row = 0) {
    if (++item >= pending_.size()) return false;
    at = &pending_[item];
  }
  return true;
}

bool TimeGrid::next_lies_before(const Pending& front, std::size_t row, std::int64_t stamp) const {
  const Pending* at = &front;
  std::size_t item = 0;
  std::int64_t next = 0;
  return next_row(at, item, row) && !__builtin_add_overflow(at->block.time_ns[row], last_.wrap, &next) && next < stamp;
}

// Rows behind this one that a logger may have written at once.
RowsAtOnce TimeGrid::rows_at_once(const Pending& front, std::size_t row) const {
  const Pending* at = &front;
  std::size_t item = 0;
  RowsAtOnce ahead{step_.ns, front.block.time_ns[row]};
  while (next_row(at, item, row) && ahead.add(at->block.time_ns[row])) {
  }
  return ahead;
}

// How much later than expected this row and those behind it (behind those written at once) are, in steps; its own
// first.
std::vector<double> TimeGrid::lags_ahead(const Pending& front, std::size_t row, std::int64_t stamp, std::size_t ahead,
                                         std::size_t at_once) const {
  const double last_late = step_.coarse ? 0 : recent_.rows.last_late(step_.ns);
  const auto late = [&](std::int64_t t, std::size_t j) {
    return (static_cast<double>(t - last_.stamp) + last_late) / step_.ns - static_cast<double>(j + 1);
  };
  // Of two rows that changed places the second is dropped: its place is empty.
  const bool close = static_cast<double>(stamp - last_.stamp) < 3 * step_.ns;
  std::size_t dropped = 0;
  std::vector<double> lags{late(stamp, 0)};
  std::size_t item = 0, i = row;
  const Pending* at = &front;
  for (std::size_t j = 1; j < std::min(ahead, kRowsAhead + at_once); ++j) {
    if (!next_row(at, item, i)) break;
    if (j < at_once) continue;
    std::int64_t t = 0, unused = 0;
    // Rows ahead are not checked yet.
    if (__builtin_add_overflow(at->block.time_ns[i], last_.wrap, &t) ||
        __builtin_sub_overflow(t, last_.stamp, &unused) || t <= last_.stamp)
      continue;
    if (close && j == 1 && t < stamp) {
      ++dropped;
      continue;
    }
    lags.push_back(late(t, j - dropped));
  }
  return lags;
}

// Missing grid points before this row.
std::int64_t TimeGrid::lag(const Pending& front, std::size_t row, std::int64_t stamp, std::size_t ahead,
                           std::size_t at_once) const {
  // Of an interval far below a nanosecond there may be more steps than 64 bits count.
  return static_cast<std::int64_t>(clamped_whole<std::int64_t>(
      std::round(std::clamp(common_lag(lags_ahead(front, row, stamp, ahead, at_once)), -9e18, 9e18))));
}

// Rows missing in front of a packet. One that comes late, and those behind it in time, is none of them. Of packets that
// stand evenly inside a few rows are known to be missing, of others most of a packet.
std::int64_t TimeGrid::packet_lag(const Pending& front, std::size_t row, std::int64_t stamp, std::size_t ahead) const {
  constexpr double kOff = 0.35, kLate = 0.5;  // of a packet: further off it is no whole number of them, or on time
  constexpr double kLost = 0.9;               // what the last ones of a log are late by where one is missing
  constexpr double kFewRows = 1.5, kBeyond = 6, kSame = 3;  // rows; standard deviations of first rows
  constexpr std::size_t kFewest = 3;                        // at the end of a log fewer are late as one may be
  if (!recent_.packets.any()) return 0;
  const StampModel::Packets& of = step_.model.packets;
  const std::size_t most = of.alike ? 6 : 10;  // packets looked at, however many come with them: four in the mean
  const double packet = of.rows * step_.ns;
  const double least = step_.even() ? std::min(kLate * packet, std::max(kFewRows * step_.ns, kBeyond * of.scatter_ns))
                                    : std::max(kLate * packet, of.alike ? 0 : kFewRows * step_.ns);
  std::vector<double> late{recent_.packets.late(last_.index + 1, stamp, step_.ns)};
  std::size_t item = 0, i = row;
  const Pending* at = &front;
  std::int64_t before = stamp;
  const auto looked = std::min(static_cast<double>(ahead), 4 * static_cast<double>(most) * of.rows + 2);
  for (std::int64_t j = 1; static_cast<double>(j) < looked && late.size() <= most && late.back() >= least; ++j) {
    if (!next_row(at, item, i)) break;
    std::int64_t t = 0, step = 0;
    if (__builtin_add_overflow(at->block.time_ns[i], last_.wrap, &t) || __builtin_sub_overflow(t, before, &step)) break;
    before = t;
    if (step_.starts_packet(step)) late.push_back(recent_.packets.late(last_.index + 1 + j, t, step_.ns));
  }
  const bool cut = last_.ended && late.size() < kFewest;
  const double soonest = *std::min_element(late.begin(), late.end());
  if (soonest < (cut ? std::max(least, kLost * packet) : least)) return 0;
  std::erase_if(late, [&](double one) { return one > soonest + std::max(least, packet); });  // behind the next gap
  const double usual = median_in_place(late, Middle::lower), packets = usual / packet, whole = std::round(packets);
  if (usual > 9e18) return 0;
  const double off = step_.even() ? std::min(kOff, kSame * of.scatter_ns / packet) : kOff;
  const bool counted = of.alike && whole > 0 && std::fabs(packets - whole) < off;
  return static_cast<std::int64_t>(counted ? whole * of.rows : std::round(usual / step_.ns));
}

// A row with the stamp of the one before has a place of its own where those behind it stand where they would then:
// a logger held its stamp back.
bool TimeGrid::rows_go_on(const Pending& front, std::size_t row, std::size_t ahead) const {
  std::vector<double> lags = lags_ahead(front, row, last_.stamp, ahead);
  lags.erase(lags.begin());
  return lags.size() >= 4 && median_in_place(lags, Middle::lower) > -0.5;
}

}  // namespace libchar

#include "libchar/log/time/grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "libchar/core/numeric/lanes.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar {
namespace {

constexpr std::size_t kTogether = 256;  // rows whose stamps are looked at together

/// The largest or the smallest number where the difference does not fit.
std::int64_t whole_step(std::int64_t from, std::int64_t to) {
  std::int64_t step = 0;
  return __builtin_sub_overflow(to, from, &step) ? (to > from ? INT64_MAX : INT64_MIN) : step;
}

/// All n stamps are `shortest` (>= 1) to `longest` after the one before.
LIBCHAR_LANES bool steps_between_lanes(std::int64_t before, const std::int64_t* stamps, std::size_t n,
                                       std::int64_t shortest, std::int64_t longest) {
  // Differences wrap: a rising pair whose difference does not fit becomes negative.
  const auto step = [](std::int64_t from, std::int64_t to) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from));
  };
  const auto fits = [&](std::int64_t from, std::int64_t to) -> int {
    return int{to > from} & int{step(from, to) >= shortest} & int{step(from, to) <= longest};
  };
  if (n == 0) return true;
  std::int64_t good = fits(before, stamps[0]);
  for (std::size_t i = 1; i < n; ++i) good &= fits(stamps[i - 1], stamps[i]);
  return good != 0;
}
constexpr InLanes<steps_between_lanes> steps_between;

}  // namespace

TimeGrid::TimeGrid(const RowSource& source, const ReadOptions& options, BlockSink& sink, Findings& warnings)
    : source_(source), options_(options), output_(sink), warnings_(warnings) {
  const auto instant = [](const std::optional<double>& s, std::int64_t otherwise, const char* name) {
    if (!s) return otherwise;
    if (!std::isfinite(*s) || std::fabs(*s) > 9e9)
      throw usage_error("E0201", name).says("is not a time in seconds").got(shortest(*s));
    return clamped_whole<std::int64_t>(std::round(*s * 1e9));
  };
  window_.from_ns = instant(options.from_s, 0, "`from_s`");
  window_.to_ns = instant(options.to_s, INT64_MAX, "`to_s`");
  if (window_.to_ns <= window_.from_ns)
    throw usage_error("E0201", "`to_s`").says("the window is empty: `to_s` does not lie after `from_s`");
}

bool TimeGrid::push(RowBlock& block) {
  if (counts_.rows == 0) stamped_ = !block.time_ns.empty();
  Pending item;
  item.rows_before = counts_.rows;
  counts_.rows += block.rows;
  std::swap(item.block, block);
  const bool undecided = stamped_ && !clocks_.rows.decided();
  if (undecided) {
    clocks_.copies.look(item.block);
    clocks_.rows.decide(item.block);
  }
  if (!spare_.empty()) {
    block = std::move(spare_.back());
    spare_.pop_back();
  }
  pending_.push_back(std::move(item));
  if (stamped_ && clocks_.rows.decided()) {
    if (undecided) clocks_.copies.decide();
    for (Pending& waiting : pending_) leave_out(waiting);
  }
  if (clocks_.packets.any()) clocks_.packets.spread(pending_.back().block.time_ns, 0);
  waiting_ = 0;
  for (const Pending& waiting : pending_) waiting_ += waiting.block.rows - waiting.done;
  process(false);
  return !window_.over;
}

void TimeGrid::begin() {
  if (began_) return;
  began_ = true;
  LogInfo so_far = source_.info();
  if (stamped_) {
    so_far.time.from_stamps = true;
    so_far.time.rate_hz = step_.ns > 0 ? 1e9 / step_.ns : 0;
  } else if (options_.rate_hz) {
    so_far.time.rate_hz = *options_.rate_hz;
  }
  output_.begin(so_far);
}

void TimeGrid::process(bool end) {
  if (!stamped_) {
    while (!pending_.empty() && !window_.over) {
      clocks_.channels.look(pending_.front().block, 0, pending_.front().block.rows);
      without_stamps(pending_.front());
      spare_.push_back(std::move(pending_.front().block));
      pending_.pop_front();
    }
    waiting_ = 0;
    return;
  }
  // More than two packets, of at most so many values.
  const std::size_t ahead = end ? 0 : RowsAtOnce::most(source_.info().channels.size()) + kRowsAhead;
  while ((learned_ || ready(end)) && waiting_ > ahead && !window_.over) {
    if (!learned_) learn();
    Pending& front = pending_.front();
    const std::size_t count =
        std::min(detail::in_memory(front.block.rows - front.done), detail::in_memory(waiting_ - ahead));
    const std::size_t taken = process_rows(front, count);
    clocks_.channels.look(front.block, front.done, front.done + taken);
    front.done += taken;
    waiting_ -= taken;
    if (front.done == front.block.rows) {
      if (front.block.rows > 0) last_.end_of_block = place(front, front.block.rows - 1);
      if (spare_.size() < 4) spare_.push_back(std::move(front.block));
      pending_.pop_front();
    }
  }
}

// Rows whose stamps all follow each other as they should are taken together; a run of them goes to the sink without
// being copied. Says how many rows it took: not all where the window begins among them.
std::size_t TimeGrid::process_rows(Pending& front, std::size_t count) {
  const std::size_t begin = front.done, stop = begin + count;
  std::size_t run = begin, end = stop;
  for (std::size_t from = begin; from < stop; from += kTogether) {
    const std::size_t to = std::min(stop, from + kTogether);
    if (take_regular(front.block.time_ns.data() + from, to - from)) continue;
    const auto ahead = static_cast<std::size_t>(waiting_) - (from - begin);
    const std::size_t taken = take_one_by_one(front, from, to, ahead, run);
    if (taken == to) continue;
    end = window_.over ? stop : taken;
    if (window_.over) run = stop;
    break;
  }
  output_.rows(front.block, std::min(run, end), end);
  return end - begin;
}

/// False, and nothing is taken, when one of the rows needs a decision.
bool TimeGrid::take_regular(const std::int64_t* time, std::size_t n) {
  if (!last_.any || last_.wrap != 0) return false;
  if (!steps_between(last_.stamp, time, n, step_.shortest, step_.longest)) return false;
  // They rise: the last is the furthest.
  if (time[n - 1] >= kMostNs || time[n - 1] - last_.first > kMostNs) return false;
  if (time[0] - last_.first < window_.from_ns || time[n - 1] - last_.first >= window_.to_ns) return false;
  if (!window_.begun) return false;
  if (backward_.in_a_row > 0) backward_ = {};
  sketch_.add_run(last_.index + 1, time, n);
  recent_.rows.push(time, n);
  last_.index += static_cast<std::int64_t>(n);
  last_.row += static_cast<std::int64_t>(n);
  last_.as_read = last_.stamp = time[n - 1];
  if (!start_ns_) start_ns_ = time[0];
  counts_.used += n;
  return true;
}

/// Rows [from, to), of which those from `run` on are not passed on yet. Says where it ended: in front
/// of the window's first row, whose interval is to be learnt, or of the first one behind the window.
std::size_t TimeGrid::take_one_by_one(Pending& front, std::size_t from, std::size_t to, std::size_t ahead,
                                      std::size_t& run) {
  const std::int64_t* const time = front.block.time_ns.data();
  for (std::size_t i = from; i < to; ++i) {
    std::int64_t stamp = 0;
    if (__builtin_add_overflow(time[i], last_.wrap, &stamp)) stamp = INT64_MAX;
    stamp = checked(front, i, stamp);
    if (!window_.begun && last_.any && whole_step(last_.first, stamp) >= window_.from_ns) {
      learned_ = false;
      return i;
    }
    const std::int64_t step = last_.any ? whole_step(last_.stamp, stamp) : 0;
    if (last_.any && step > 0 && step_.steady && between_samples(front, i, stamp)) {
      output_.rows(front.block, run, i);
      run = i + 1;
      ++counts_.dropped;
      continue;
    }
    if (step <= 0 || step > step_.longest) {
      output_.rows(front.block, run, i);
      run = i;
      if (decide(front, i, stamp, ahead - (i - from)) == Verdict::drop) {
        ++counts_.dropped;
        run = i + 1;
        continue;
      }
    }
    if (backward_.in_a_row > 0) backward_ = {};
    if (last_.any && !step_.coarse) watch_step(front, i, whole_step(last_.stamp, stamp));
    ++last_.index;
    ++last_.row;
    last_.as_read = time[i] + last_.wrap;
    last_.stamp = stamp;
    last_.any = true;
    sketch_.add(last_.index, stamp);
    recent_.rows.push(stamp);
    if (step_.starts_packet(step)) recent_.packets.push(last_.index, stamp);
    if (place_in_window(stamp)) continue;
    if (!window_.over) {
      run = i + 1;
      continue;
    }
    output_.rows(front.block, run, i);
    return i;
  }
  return to;
}

/// A row without a value, where the next one follows the last as it should: a logger's event, which has no place.
bool TimeGrid::between_samples(const Pending& front, std::size_t row, std::int64_t stamp) {
  std::size_t item = 0, next = row;
  const Pending* at = &front;
  if (!blank_row(front.block, row)) return false;
  std::int64_t t = 0;
  const bool any = next_row(at, item, next);
  if (any && __builtin_add_overflow(at->block.time_ns[next], last_.wrap, &t)) return false;
  constexpr double kLongest = 1.1;  // steps
  const std::int64_t step = any ? whole_step(last_.stamp, t) : step_.shortest;
  if (step < step_.shortest || static_cast<double>(step) > kLongest * step_.ns ||
      (!any && stamp - last_.stamp >= step_.shortest))
    return false;
  warnings_.add("own_rows",
                "rows without a value of the channels that are read are left out: these have a clock of their own",
                place(front, row));
  return true;
}

/// Steps that are none of the grid's may be another rate.
void TimeGrid::watch_step(const Pending& front, std::size_t row, std::int64_t step) {
  if (step > 0 && (step < step_.shortest || step > step_.longest) &&
      watch_.add(static_cast<std::uint64_t>(last_.row) + 1, static_cast<double>(step) / step_.ns,
                 last_.stamp - last_.first))
    watch_.keep_place(row > 0 ? place(front, row - 1) : last_.end_of_block);
}

bool TimeGrid::place_in_window(std::int64_t stamp) {
  if (stamp - last_.first < window_.from_ns) {
    ++counts_.outside;
    return false;
  }
  window_.over = stamp - last_.first >= window_.to_ns;
  if (window_.over) return false;
  if (!start_ns_) start_ns_ = stamp;
  ++counts_.used;
  return true;
}

void TimeGrid::without_stamps(Pending& front) {
  begin();
  const double rate = options_.rate_hz ? *options_.rate_hz : source_.info().time.rate_hz;
  std::size_t from = 0, to = front.block.rows;
  if (options_.from_s || options_.to_s) {
    if (!(rate > 0))
      throw usage_error("E0205", source_.info().file)
          .says("`from_s` and `to_s` need a time base, and the log has neither stamps nor a rate")
          .hint("`rate_hz` HZ gives it");
    const auto grid = [&](std::int64_t ns) { return std::ceil(static_cast<double>(ns) * 1e-9 * rate - 1e-6); };
    const double base = static_cast<double>(front.rows_before), rows = static_cast<double>(front.block.rows);
    from = static_cast<std::size_t>(std::clamp(grid(window_.from_ns) - base, 0.0, rows));
    to = window_.to_ns == INT64_MAX ? front.block.rows
                                    : static_cast<std::size_t>(std::clamp(grid(window_.to_ns) - base, 0.0, rows));
    window_.over = to < front.block.rows;
  }
  const std::size_t inside = to > from ? to - from : 0;
  counts_.used += inside;
  if (!window_.over) counts_.outside += front.block.rows - inside;
  output_.rows(front.block, from, to);
}

// The rate that most of the log keeps, unless rows over time contradict it. Pauses are left out.
double TimeGrid::even_interval() {
  const double usual = step_.coarse ? sketch_.line_ns() : sketch_.interval_ns();
  const double spanned = sketch_.span_ns(last_.index, last_.stamp);
  if (behind_.needed && !behind_.ns && spanned > 0) return spanned;
  const double off = std::abs(usual - spanned), rows = static_cast<double>(last_.index);
  constexpr double kAsBehind = 5e-4;
  if (behind_.ns && std::abs(usual - *behind_.ns) > kAsBehind * usual) {
    warnings_.add(
        "uneven_sampling",
        fmt::format(
            "stamps come late by up to an interval and more: the clock behind them has {} Hz, which is used. "
            "Rows on the grid have {} Hz: which of them are missing is a guess, and times on the axes are off by that",
            brief_text(1e9 / *behind_.ns, 6), brief_text(1e9 / usual, 6)));
    return *behind_.ns;
  }
  if (step_.even()) {  // inside packets, whose first rows scatter: does the line through these say another interval?
    constexpr double kWithin = 5;
    const StampModel::Packets& of = step_.model.packets;
    const double error = of.scatter_ns * std::sqrt(12 * of.rows / rows) / rows;
    if (std::abs(usual - step_.model.step_ns) <= kWithin * error) return step_.model.step_ns;
  }
  const double ends = std::max(2.0 * static_cast<double>(step_.longest),  // where the log begins and ends in a packet
                               1.5 * step_.model.packets.rows * step_.ns);
  if (!(spanned > 0) || off * rows <= std::max(0.01 * spanned * rows, ends)) return usual;
  warnings_.add("uneven_sampling", fmt::format("long stretches of the log keep {} Hz, rows over time are {} Hz, which "
                                               "is used: the sampling is uneven, and times on the axes are off by that",
                                               brief_text(1e9 / usual, 5), brief_text(1e9 / spanned, 5)));
  return spanned;
}

// Of the whole log, or of its first rows, where the grid learnt their step and found gaps by it, or where steps (`odd`)
// or rows over time tell them.
std::optional<RateChange> TimeGrid::lasting_change(bool odd) const {
  constexpr double kOther = 0.03, kUneven = 0.01;
  auto change = sketch_.rate_change();
  const double usual = sketch_.interval_ns(), spanned = sketch_.span_ns(last_.index, last_.stamp);
  const bool spoilt = odd || (counts_.missing > 0 && std::abs(step_.ns - usual) > kOther * usual) ||
                      std::abs(spanned - usual) > kUneven * usual;
  for (const std::size_t parts : {4U, 16U})
    if (!change && spoilt) change = sketch_.rate_change(parts);
  return change;
}

// Two rates make no grid: one of the stretches has to be chosen. A few rows at another rate are said
// and, as are rows of which only each second or third is there, placed on the grid.
void TimeGrid::judge_rate_change() {
  constexpr std::uint64_t kShare = 50, kRows = 64;
  if (step_.coarse || source_.several_clocks()) return;
  watch_.end();
  const OddRun& odd = watch_.longest();
  double before = 1e9 / step_.ns, after = before / odd.intervals;
  auto at_ns = static_cast<double>(odd.began_ns);
  // Of rows of which each second is left out, as many as have the grid's rate are a change.
  const bool another = !odd.whole() || 2 * odd.rows > counts_.used;
  bool asks = odd.rows >= kRows && another && kShare * odd.rows >= counts_.used;
  if (asks && at_ns - static_cast<double>(window_.from_ns) < 4 * odd.intervals * step_.ns) {
    std::swap(before, after);  // the first rows are the odd ones
    at_ns = static_cast<double>(odd.ended_ns) + odd.intervals * step_.ns;
  }
  if (const auto change = lasting_change(asks); change && (asks || odd.rows == 0 || odd.whole())) {
    asks = true;
    at_ns = change->row;                 // which says the place better
    if (odd.rows == 0 || odd.whole()) {  // else rows of the other rate have taken more than a place each
      before = 1e9 / change->before_ns;
      after = 1e9 / change->after_ns;
    }
  }
  if (asks) {
    const std::string at = shortest(std::round(at_ns * 1e-6) / 1e3);
    throw input_error("E0334", source_.info().file)
        .says("the sampling rate changes {} s after the first stamp, from {} to {} Hz: no grid holds both", at,
              brief_text(before, 5), brief_text(after, 5))
        .hint(
            "`to_s` {} reads what is before it, `from_s` {} what follows, `time_column` none and `rate_hz` HZ the rows "
            "one after the other",
            at, at);
  }
  if (odd.rows > 0)
    warnings_.add("rate_change",
                  fmt::format("the sampling rate changes ({} to {} Hz): the grid keeps the first",
                              brief_text(before, 6), brief_text(after, 6)),
                  odd.place);
}

// Rows written within a tenth of the time, again and again: their rate is that inside the bursts, or that over time.
void TimeGrid::refuse_bursts() const {
  constexpr std::uint64_t kFaster = 9;  // missing samples for each that is there
  const double period = options_.rate_hz || counts_.missing < kFaster * counts_.used ? 0 : bursts_.period();
  if (!(period > 0)) return;
  const double inside = 1e9 / step_.ns;
  const auto rows = static_cast<double>(counts_.used), all = rows + static_cast<double>(counts_.missing);
  throw input_error("E0324", source_.info().file)
      .says(
          "two sampling rates: the rows come in bursts, one each {}, at {} inside and {} over time: a slow link or a "
          "sensor that pauses",
          duration_text(period * 1e-9), detail::frequency_text(inside, 5),
          detail::frequency_text(inside * rows / all, 5))
      .hint("`rate_hz` {} takes the pauses as gaps, `time_column` none with `rate_hz` {} the rows one after the other",
            shortest(rounded(inside, 5)), shortest(rounded(inside * rows / all, 5)));
}

void TimeGrid::finish(LogInfo& info) {
  last_.ended = true;
  process(true);
  begin();
  output_.flush();
  // What stands behind the window was not looked at.
  if (window_.over) counts_.outside = counts_.rows - counts_.used - counts_.dropped;
  if (counts_.rows != counts_.used + counts_.dropped + counts_.outside ||
      output_.delivered() != counts_.used + counts_.missing)
    throw std::logic_error("time grid: the account of rows does not balance");
  info.rows = counts_.rows;
  info.rows_used = counts_.used;
  info.rows_dropped = counts_.dropped;
  info.rows_outside = counts_.outside;
  info.samples = output_.delivered();
  TimeBase& time = info.time;
  if (!stamped_) {
    if (!options_.rate_hz) return;
    time.rate_hz = *options_.rate_hz;
    const double off = options_.unsaid.rate_uncertainty_hz / time.rate_hz;
    if (off > 0)
      warnings_.add("rate_uncertain", fmt::format("the rate is known to ± {}: times too, N and K to ± {} in addition "
                                                  "to their intervals",
                                                  percent_text(off), percent_text(off / 2)));
    return;
  }
  time.from_stamps = true;
  time.start_ns = start_ns_;
  time.gaps = counts_.gaps;
  time.missing_samples = counts_.missing;
  refuse_many_backward();
  judge_rate_change();
  refuse_bursts();
  const double interval = even_interval();
  time.rate_hz = interval > 0 ? 1e9 / interval : 0;
  const auto deviation = sketch_.deviation(interval);
  time.jitter_s = deviation.robust * 1e-9;
  time.max_deviation_s = deviation.largest * 1e-9;
  if (interval > 0 && deviation.robust > 0.1 * interval)
    warnings_.add("jitter",
                  fmt::format("stamps scatter by {} of the sampling interval: the samples are treated as evenly spaced",
                              percent_text(deviation.robust / interval)));
  const double tolerance = options_.unsaid.rate_uncertainty_hz > 0
                               ? options_.unsaid.rate_uncertainty_hz / options_.rate_hz.value_or(1)
                               : 0.01;
  if (options_.rate_hz && options_.unsaid.channel_rate.empty() && interval > 0 &&
      std::abs(*options_.rate_hz * interval * 1e-9 - 1) > tolerance)
    warnings_.add("rate_ignored", fmt::format("the stamps give {} Hz; the rate of {} Hz that was given is not used "
                                              "(`time_column` none ignores the stamps)",
                                              brief_text(1e9 / interval, 6), brief_text(*options_.rate_hz, 6)));
}

}  // namespace libchar

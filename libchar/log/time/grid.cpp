#include "libchar/log/time/grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "libchar/core/decimal.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/lanes.hpp"
#include "libchar/core/readable.hpp"

namespace libchar {
namespace {

constexpr std::size_t kLearn = 1025;    // rows whose stamps decide on dt
constexpr std::size_t kStaging = 8192;  // rows assembled where the grid is irregular
constexpr std::size_t kTogether = 256;  // rows whose stamps are looked at together

/// All n stamps are `shortest` (>= 1) to `longest` after the one before.
LIBCHAR_WIDE_LANES bool steps_between(std::int64_t before,
                                      const std::int64_t* stamps,
                                      std::size_t n,
                                      std::int64_t shortest,
                                      std::int64_t longest) {
  // Differences wrap: a rising pair whose difference does not fit becomes negative.
  const auto step = [](std::int64_t from, std::int64_t to) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(to) -
                                     static_cast<std::uint64_t>(from));
  };
  const auto fits = [&](std::int64_t from, std::int64_t to) -> int {
    return int{to > from} & int{step(from, to) >= shortest} & int{step(from, to) <= longest};
  };
  if (n == 0) return true;
  std::int64_t good = fits(before, stamps[0]);
  for (std::size_t i = 1; i < n; ++i) good &= fits(stamps[i - 1], stamps[i]);
  return good != 0;
}

}  // namespace

TimeGrid::TimeGrid(const RowSource& source,
                   const ReadOptions& options,
                   BlockSink& sink,
                   Warnings& warnings)
    : source_(source), options_(options), sink_(sink), warnings_(warnings) {
  const auto instant = [](const std::optional<double>& s,
                          std::int64_t otherwise,
                          const char* name) {
    if (!s) return otherwise;
    if (!std::isfinite(*s) || std::fabs(*s) > 9e9)
      throw Error({ErrorKind::usage, "E0201", name, "is not a time in seconds", shortest(*s), ""});
    return static_cast<std::int64_t>(std::llround(*s * 1e9));
  };
  from_ns_ = instant(options.from_s, 0, "`from_s`");
  to_ns_ = instant(options.to_s, INT64_MAX, "`to_s`");
  if (to_ns_ <= from_ns_)
    throw Error({ErrorKind::usage,
                 "E0201",
                 "`to_s`",
                 "the window is empty: `to_s` does not lie after `from_s`",
                 "",
                 ""});
}

bool TimeGrid::push(RowBlock& block) {
  if (rows_ == 0) stamped_ = !block.time_ns.empty();
  Pending item;
  item.rows_before = rows_;
  rows_ += block.rows;
  waiting_ += block.rows;
  std::swap(item.block, block);
  if (!spare_.empty()) {
    block = std::move(spare_.back());
    spare_.pop_back();
  }
  pending_.push_back(std::move(item));
  process(false);
  return !window_over_;
}

void TimeGrid::begin() {
  if (began_) return;
  began_ = true;
  LogInfo so_far = source_.info();
  if (stamped_) {
    so_far.time.from_stamps = true;
    so_far.time.rate_hz = dt_ > 0 ? 1e9 / dt_ : 0;
  } else if (options_.rate_hz) {
    so_far.time.rate_hz = *options_.rate_hz;
  }
  staging_.resize(so_far.channels.size());
  sink_.begin(so_far);
}

void TimeGrid::process(bool end) {
  if (!stamped_) {
    while (!pending_.empty() && !window_over_) {
      without_stamps(pending_.front());
      spare_.push_back(std::move(pending_.front().block));
      pending_.pop_front();
    }
    waiting_ = 0;
    return;
  }
  if (!learned_) {
    if (waiting_ < kLearn && !end) return;
    if (waiting_ == 0) return;
    learn();
  }
  const std::size_t ahead = end ? 0 : kRowsAhead;
  while (waiting_ > ahead && !window_over_) {
    Pending& front = pending_.front();
    const std::size_t count =
        std::min<std::size_t>(front.block.rows - front.done, waiting_ - ahead);
    process_rows(front, count);
    front.done += count;
    waiting_ -= count;
    if (front.done == front.block.rows) {
      end_of_block_ = place(front, front.block.rows - 1);
      if (spare_.size() < 4) spare_.push_back(std::move(front.block));
      pending_.pop_front();
    }
  }
}

void TimeGrid::learn() {
  learned_ = true;
  std::vector<std::int64_t> stamps;
  for (const Pending& item : pending_)
    for (std::size_t i = 0; i < item.block.rows && stamps.size() < kLearn; ++i)
      stamps.push_back(checked(item, i, item.block.time_ns[i]));
  const FirstInterval found = first_interval(stamps, options_.rate_hz);
  dt_ = found.ns;
  coarse_ = found.pattern != StampPattern::steps;
  limit_ = static_cast<std::int64_t>(std::min(found.longest_step, 9e18));
  const auto whole = static_cast<std::int64_t>(std::min(dt_, 9e18));
  least_ = std::max<std::int64_t>(1, whole - whole / 4);  // three quarters of it, rounded up
  if (dt_ == 0 && stamps.size() > 1) {
    const Pending* item = &pending_.front();
    std::size_t row = 1;
    if (item->block.rows < 2) {
      item = &pending_[1];
      row = 0;
    }
    const bool equal =
        std::all_of(stamps.begin(), stamps.end(), [&](std::int64_t s) { return s == stamps[0]; });
    fail(*item,
         row,
         "E0315",
         equal ? "no time axis: all stamps are equal" : "no time axis: the stamps never rise",
         "`time_column` none and `rate_hz` HZ ignore the stamps");
  }
  say_pattern(found);
  begin();
}

void TimeGrid::say_pattern(const FirstInterval& found) {
  const double step_hz = 1e9 / found.step_ns, span_hz = 1e9 / found.span_ns;
  switch (found.pattern) {
    case StampPattern::steps:
      return;
    case StampPattern::equal:
      warnings_.add("coarse_stamps",
                    "the clock is too coarse to tell rows apart (many equal stamps): rows are kept "
                    "and spaced evenly");
      return;
    case StampPattern::coarse:
      warnings_.add("coarse_stamps",
                    fmt::format("the stamps are rounded to a coarse clock and keep to one line at "
                                "{} Hz: rows are spaced evenly (`rate_hz` {} takes the "
                                "longer steps as gaps)",
                                brief_text(span_hz, 5),
                                shortest(rounded(step_hz, 5))));
      return;
    case StampPattern::packets:
      warnings_.add("packets",
                    fmt::format("the stamps are those of packets: rows are spaced evenly at "
                                "{} Hz, rows over time (`rate_hz` {}, the rate inside a "
                                "packet, takes the rest as gaps)",
                                brief_text(span_hz, 5),
                                shortest(rounded(step_hz, 5))));
      return;
    case StampPattern::disputed:
      fail(pending_.front(),
           0,
           "E0324",
           fmt::format("two sampling rates: most stamps follow each other at {} Hz, rows over "
                       "time give {} Hz, and gaps do not explain it",
                       brief_text(step_hz, 5),
                       brief_text(span_hz, 5)),
           fmt::format("`rate_hz` {} or `rate_hz` {} decides",
                       shortest(rounded(step_hz, 5)),
                       shortest(rounded(span_hz, 5))));
  }
}

// Rows whose stamps all follow each other as they should are taken together; a run of them goes to
// the sink without being copied.
void TimeGrid::process_rows(Pending& front, std::size_t count) {
  const std::size_t stop = front.done + count;
  std::size_t run = front.done;
  for (std::size_t from = front.done; from < stop; from += kTogether) {
    const std::size_t to = std::min(stop, from + kTogether);
    if (take_regular(front.block.time_ns.data() + from, to - from)) continue;
    const auto ahead = static_cast<std::size_t>(waiting_) - (from - front.done);
    if (!take_one_by_one(front, from, to, ahead, run)) {
      run = stop;
      break;
    }
  }
  emit_rows(front.block, std::min(run, stop), stop);
}

/// False, and nothing is taken, when one of the rows needs a decision.
bool TimeGrid::take_regular(const std::int64_t* time, std::size_t n) {
  if (!have_last_ || wrap_ != 0 || same_ratio_ != 0) return false;
  if (!steps_between(last_, time, n, least_, limit_)) return false;
  // They rise: the last is the furthest.
  if (time[n - 1] >= kMostNs || time[n - 1] - first_stamp_ > kMostNs) return false;
  if (time[0] - first_stamp_ < from_ns_ || time[n - 1] - first_stamp_ >= to_ns_) return false;
  dropped_in_a_row_ = 0;
  sketch_.add_run(index_ + 1, time, n);
  index_ += static_cast<std::int64_t>(n);
  raw_last_ = last_ = time[n - 1];
  if (!start_ns_) start_ns_ = time[0];
  used_ += n;
  return true;
}

/// Rows [from, to), of which those from `run` on are not passed on yet; false when the window ends
/// among them.
bool TimeGrid::take_one_by_one(
    Pending& front, std::size_t from, std::size_t to, std::size_t ahead, std::size_t& run) {
  const std::int64_t* const time = front.block.time_ns.data();
  for (std::size_t i = from; i < to; ++i) {
    std::int64_t stamp = 0;
    if (__builtin_add_overflow(time[i], wrap_, &stamp)) stamp = INT64_MAX;
    stamp = checked(front, i, stamp);
    const std::int64_t step = have_last_ ? stamp - last_ : 0;
    const bool regular = step > 0 && step <= limit_;
    if (!regular) {
      emit_rows(front.block, run, i);
      run = i;
      if (decide(front, i, stamp, ahead - (i - from)) == Verdict::drop) {
        ++dropped_;
        run = i + 1;
        continue;
      }
    } else if (!coarse_ && (same_ratio_ != 0 || step < least_)) {
      watch_rate(front, i, static_cast<double>(step) / dt_);
    }
    dropped_in_a_row_ = 0;
    ++index_;
    raw_last_ = time[i] + wrap_;
    last_ = stamp;
    have_last_ = true;
    sketch_.add(index_, stamp);
    if (stamp - first_stamp_ < from_ns_) {
      ++outside_;
      run = i + 1;
    } else if (stamp - first_stamp_ >= to_ns_) {
      emit_rows(front.block, run, i);
      window_over_ = true;
      return false;
    } else {
      if (!start_ns_) start_ns_ = stamp;
      ++used_;
    }
  }
  return true;
}

void TimeGrid::without_stamps(Pending& front) {
  begin();
  const double rate = options_.rate_hz ? *options_.rate_hz : source_.info().time.rate_hz;
  std::size_t from = 0, to = front.block.rows;
  if (options_.from_s || options_.to_s) {
    if (!(rate > 0))
      throw Error(
          {ErrorKind::usage,
           "E0205",
           source_.info().file,
           "`from_s` and `to_s` need a time base, and the log has neither stamps nor a rate",
           "",
           "`rate_hz` HZ gives it"});
    const auto grid = [&](std::int64_t ns) {
      return std::ceil(static_cast<double>(ns) * 1e-9 * rate - 1e-6);
    };
    const double base = static_cast<double>(front.rows_before),
                 rows = static_cast<double>(front.block.rows);
    from = static_cast<std::size_t>(std::clamp(grid(from_ns_) - base, 0.0, rows));
    to = to_ns_ == INT64_MAX ? front.block.rows
                             : static_cast<std::size_t>(std::clamp(grid(to_ns_) - base, 0.0, rows));
    window_over_ = to < front.block.rows;
  }
  const std::size_t inside = to > from ? to - from : 0;
  used_ += inside;
  if (!window_over_) outside_ += front.block.rows - inside;
  emit_rows(front.block, from, to);
}

void TimeGrid::emit_rows(const RowBlock& block, std::size_t from, std::size_t to) {
  if (from >= to) return;
  const std::size_t rows = to - from;
  if (rows >= 1024) {
    flush();
    std::vector<const double*> channels;
    for (const auto& column : block.columns) channels.push_back(column.data() + from);
    deliver(channels, rows);
    return;
  }
  for (std::size_t c = 0; c < staging_.size(); ++c) {
    staging_[c].resize(staged_);
    staging_[c].insert(staging_[c].end(),
                       block.columns[c].begin() + static_cast<std::ptrdiff_t>(from),
                       block.columns[c].begin() + static_cast<std::ptrdiff_t>(to));
  }
  staged_ += rows;
  if (staged_ >= kStaging) flush();
}

void TimeGrid::emit_missing(std::uint64_t count) {
  while (count > 0) {
    const std::size_t n = static_cast<std::size_t>(std::min<std::uint64_t>(count, kStaging));
    staged_ += n;
    for (auto& column : staging_) column.resize(staged_, kMissing);
    if (staged_ >= kStaging) flush();
    count -= n;
  }
}

void TimeGrid::flush() {
  if (staged_ == 0) return;
  std::vector<const double*> channels;
  for (const auto& column : staging_) channels.push_back(column.data());
  deliver(channels, staged_);
  staged_ = 0;
  for (auto& column : staging_) column.clear();
}

void TimeGrid::deliver(const std::vector<const double*>& channels, std::size_t rows) {
  SampleBlock block;
  block.first = delivered_;
  block.rows = rows;
  block.channels = channels;
  delivered_ += rows;
  sink_.block(block);
}

// The rate that most of the log keeps, unless rows over time contradict it.
double TimeGrid::even_interval() {
  const double usual = coarse_ ? sketch_.line_ns() : sketch_.interval_ns();
  const double stamped = static_cast<double>(last_ - first_stamp_);
  const double off = std::abs(static_cast<double>(index_) * usual - stamped);
  if (index_ <= 0 || off <= std::max(0.01 * stamped, 2.0 * static_cast<double>(limit_)))
    return usual;
  const double spanned = stamped / static_cast<double>(index_);
  warnings_.add("uneven_sampling",
                fmt::format("long stretches of the log keep {} Hz, rows over time are {} "
                            "Hz, which is used: the sampling is uneven, and times on the axes are "
                            "off by that",
                            brief_text(1e9 / usual, 5),
                            brief_text(1e9 / spanned, 5)));
  return spanned;
}

void TimeGrid::finish(LogInfo& info) {
  process(true);
  begin();
  flush();
  // What stands behind the window was not looked at.
  if (window_over_) outside_ = rows_ - used_ - dropped_;
  if (rows_ != used_ + dropped_ + outside_ || delivered_ != used_ + missing_)
    throw std::logic_error("time grid: the account of rows does not balance");
  info.rows = rows_;
  info.rows_used = used_;
  info.rows_dropped = dropped_;
  info.rows_outside = outside_;
  info.samples = delivered_;
  TimeBase& time = info.time;
  if (!stamped_) {
    if (options_.rate_hz) time.rate_hz = *options_.rate_hz;
    return;
  }
  time.from_stamps = true;
  time.start_ns = start_ns_;
  time.gaps = gaps_;
  time.missing_samples = missing_;
  const double interval = even_interval();
  time.rate_hz = interval > 0 ? 1e9 / interval : 0;
  const auto deviation = sketch_.deviation(interval);
  time.jitter_s = deviation.robust * 1e-9;
  time.max_deviation_s = deviation.largest * 1e-9;
  if (interval > 0 && deviation.robust > 0.1 * interval)
    warnings_.add("jitter",
                  fmt::format("stamps scatter by {} of the sampling interval: the samples "
                              "are treated as evenly spaced",
                              percent_text(deviation.robust / interval)));
  if (options_.rate_hz && interval > 0 && std::abs(*options_.rate_hz * interval * 1e-9 - 1) > 0.01)
    warnings_.add("rate_ignored",
                  fmt::format("the stamps give {} Hz; the rate of {} Hz that was given is not "
                              "used (`time_column` none ignores the stamps)",
                              brief_text(1e9 / interval, 6),
                              brief_text(*options_.rate_hz, 6)));
}

}  // namespace libchar

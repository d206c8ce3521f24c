#include "libchar/log/time/grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "libchar/core/error.hpp"
#include "libchar/core/numeric/lanes.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"

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

void GridOutput::begin(const LogInfo& so_far) {
  staging_.resize(so_far.channels.size());
  sink_.begin(so_far);
}

void GridOutput::rows(const RowBlock& block, std::size_t from, std::size_t to) {
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

void GridOutput::missing(std::uint64_t count) {
  while (count > 0) {
    const std::size_t n = static_cast<std::size_t>(std::min<std::uint64_t>(count, kStaging));
    staged_ += n;
    for (auto& column : staging_) column.resize(staged_, kMissing);
    if (staged_ >= kStaging) flush();
    count -= n;
  }
}

void GridOutput::flush() {
  if (staged_ == 0) return;
  std::vector<const double*> channels;
  for (const auto& column : staging_) channels.push_back(column.data());
  deliver(channels, staged_);
  staged_ = 0;
  for (auto& column : staging_) column.clear();
}

void GridOutput::deliver(const std::vector<const double*>& channels, std::size_t rows) {
  sink_.block({delivered_, rows, channels});
  delivered_ += rows;
}

TimeGrid::TimeGrid(const RowSource& source,
                   const ReadOptions& options,
                   BlockSink& sink,
                   Warnings& warnings)
    : source_(source), options_(options), output_(sink), warnings_(warnings) {
  const auto instant =
      [](const std::optional<double>& s, std::int64_t otherwise, const char* name) {
        if (!s) return otherwise;
        if (!std::isfinite(*s) || std::fabs(*s) > 9e9)
          throw Error({ErrorKind::usage, "E0201", name, "is not a time in seconds", shortest(*s)});
        return static_cast<std::int64_t>(std::llround(*s * 1e9));
      };
  window_.from_ns = instant(options.from_s, 0, "`from_s`");
  window_.to_ns = instant(options.to_s, INT64_MAX, "`to_s`");
  if (window_.to_ns <= window_.from_ns)
    throw Error({ErrorKind::usage,
                 "E0201",
                 "`to_s`",
                 "the window is empty: `to_s` does not lie after `from_s`"});
}

bool TimeGrid::push(RowBlock& block) {
  if (counts_.rows == 0) stamped_ = !block.time_ns.empty();
  Pending item;
  item.rows_before = counts_.rows;
  counts_.rows += block.rows;
  waiting_ += block.rows;
  std::swap(item.block, block);
  if (!spare_.empty()) {
    block = std::move(spare_.back());
    spare_.pop_back();
  }
  pending_.push_back(std::move(item));
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
  while (waiting_ > ahead && !window_.over) {
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
  step_.ns = found.ns;
  step_.coarse = found.pattern != StampPattern::steps;
  step_.longest = static_cast<std::int64_t>(std::min(found.longest_step, 9e18));
  const auto whole = static_cast<std::int64_t>(std::min(step_.ns, 9e18));
  step_.shortest =
      std::max<std::int64_t>(1, whole - whole / 4);  // three quarters of it, rounded up
  if (step_.ns == 0 && stamps.size() > 1) {
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
  output_.rows(front.block, std::min(run, stop), stop);
}

/// False, and nothing is taken, when one of the rows needs a decision.
bool TimeGrid::take_regular(const std::int64_t* time, std::size_t n) {
  if (!last_.any || last_.wrap != 0 || odd_.times != 0) return false;
  if (!steps_between(last_.stamp, time, n, step_.shortest, step_.longest)) return false;
  // They rise: the last is the furthest.
  if (time[n - 1] >= kMostNs || time[n - 1] - last_.first > kMostNs) return false;
  if (time[0] - last_.first < window_.from_ns || time[n - 1] - last_.first >= window_.to_ns)
    return false;
  backward_.in_a_row = 0;
  sketch_.add_run(last_.index + 1, time, n);
  last_.index += static_cast<std::int64_t>(n);
  last_.as_read = last_.stamp = time[n - 1];
  if (!start_ns_) start_ns_ = time[0];
  counts_.used += n;
  return true;
}

/// Rows [from, to), of which those from `run` on are not passed on yet; false when the window ends
/// among them.
bool TimeGrid::take_one_by_one(
    Pending& front, std::size_t from, std::size_t to, std::size_t ahead, std::size_t& run) {
  const std::int64_t* const time = front.block.time_ns.data();
  for (std::size_t i = from; i < to; ++i) {
    std::int64_t stamp = 0;
    if (__builtin_add_overflow(time[i], last_.wrap, &stamp)) stamp = INT64_MAX;
    stamp = checked(front, i, stamp);
    const std::int64_t step = last_.any ? stamp - last_.stamp : 0;
    const bool regular = step > 0 && step <= step_.longest;
    if (!regular) {
      output_.rows(front.block, run, i);
      run = i;
      if (decide(front, i, stamp, ahead - (i - from)) == Verdict::drop) {
        ++counts_.dropped;
        run = i + 1;
        continue;
      }
    } else if (!step_.coarse && (odd_.times != 0 || step < step_.shortest)) {
      watch_rate(front, i, static_cast<double>(step) / step_.ns);
    }
    backward_.in_a_row = 0;
    ++last_.index;
    last_.as_read = time[i] + last_.wrap;
    last_.stamp = stamp;
    last_.any = true;
    sketch_.add(last_.index, stamp);
    if (stamp - last_.first < window_.from_ns) {
      ++counts_.outside;
      run = i + 1;
    } else if (stamp - last_.first >= window_.to_ns) {
      output_.rows(front.block, run, i);
      window_.over = true;
      return false;
    } else {
      if (!start_ns_) start_ns_ = stamp;
      ++counts_.used;
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
    from = static_cast<std::size_t>(std::clamp(grid(window_.from_ns) - base, 0.0, rows));
    to = window_.to_ns == INT64_MAX
             ? front.block.rows
             : static_cast<std::size_t>(std::clamp(grid(window_.to_ns) - base, 0.0, rows));
    window_.over = to < front.block.rows;
  }
  const std::size_t inside = to > from ? to - from : 0;
  counts_.used += inside;
  if (!window_.over) counts_.outside += front.block.rows - inside;
  output_.rows(front.block, from, to);
}

// The rate that most of the log keeps, unless rows over time contradict it.
double TimeGrid::even_interval() {
  const double usual = step_.coarse ? sketch_.line_ns() : sketch_.interval_ns();
  const double stamped = static_cast<double>(last_.stamp - last_.first);
  const double off = std::abs(static_cast<double>(last_.index) * usual - stamped);
  if (last_.index <= 0 || off <= std::max(0.01 * stamped, 2.0 * static_cast<double>(step_.longest)))
    return usual;
  const double spanned = stamped / static_cast<double>(last_.index);
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
    if (options_.rate_hz) time.rate_hz = *options_.rate_hz;
    return;
  }
  time.from_stamps = true;
  time.start_ns = start_ns_;
  time.gaps = counts_.gaps;
  time.missing_samples = counts_.missing;
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

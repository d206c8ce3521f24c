#include "libchar/log/time_base.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"

namespace libchar {
namespace {

constexpr std::size_t kLearn = 1025;  // rows whose stamps decide on dt
constexpr std::size_t kAhead = 16;    // rows looked at before a late stamp is called a gap
constexpr double kLargestGap = 1e8;   // grid points in one gap
constexpr std::uint64_t kBackward =
    64;                               // backward rows in a row before the clock is called restarted
constexpr double kWildSteps = 10000;  // steps ahead of its followers that make a single stamp wild
constexpr std::size_t kStaging = 8192;  // rows assembled where the grid is irregular
constexpr int kRateRun = 8;             // equal odd steps in a row that make a change of rate

double median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void StampSketch::add(std::int64_t index, std::int64_t stamp) {
  const Pair pair{index, stamp};
  if (in_cell_ == 0 || cells_.empty()) {
    if (cells_.size() == kCells) {
      thin();
    }
    cells_.push_back({pair, pair, pair});
    in_cell_ = per_cell_ - 1;
    return;
  }
  --in_cell_;
  Cell& cell = cells_.back();
  const double r = residual(pair);
  if (r < residual(cell.low)) cell.low = pair;
  if (r > residual(cell.high)) cell.high = pair;
}

double StampSketch::residual(const Pair& pair) const {
  const Pair& origin = cells_.front().first;
  return static_cast<double>(pair.stamp - origin.stamp) -
         slope_ * static_cast<double>(pair.index - origin.index);
}

void StampSketch::thin() {
  slope_ = interval_ns();
  std::size_t kept = 0;
  for (std::size_t i = 0; i + 1 < cells_.size(); i += 2) {
    Cell cell = cells_[i];
    const Cell& other = cells_[i + 1];
    for (const Pair& pair : {other.first, other.low, other.high}) {
      if (residual(pair) < residual(cell.low)) cell.low = pair;
      if (residual(pair) > residual(cell.high)) cell.high = pair;
    }
    cells_[kept++] = cell;
  }
  cells_.resize(kept);
  per_cell_ *= 2;
}

double StampSketch::interval_ns() const {
  const std::size_t n = cells_.size();
  if (n == 0) return 0;
  const std::size_t half = n / 2;
  std::vector<double> slopes;
  for (std::size_t i = 0; half > 0 && i + half < n; ++i) {
    const Pair &a = cells_[i].first, &b = cells_[i + half].first;
    slopes.push_back(static_cast<double>(b.stamp - a.stamp) /
                     static_cast<double>(b.index - a.index));
  }
  return median(slopes);
}

StampSketch::Deviation StampSketch::deviation(double interval) const {
  if (cells_.size() < 3) return {};
  const Pair origin = cells_.front().first;
  const auto off = [&](const Pair& pair) {
    return static_cast<double>(pair.stamp - origin.stamp) -
           interval * static_cast<double>(pair.index - origin.index);
  };
  std::vector<double> r;
  for (const Cell& cell : cells_) r.push_back(off(cell.first));
  const double centre = median(r);
  Deviation result;
  for (const Cell& cell : cells_)
    result.largest = std::max(
        {result.largest, std::fabs(off(cell.low) - centre), std::fabs(off(cell.high) - centre)});
  for (double& value : r) value = std::fabs(value - centre);
  result.robust = 1.4826 * median(r);
  return result;
}

FirstInterval first_interval(const std::vector<std::int64_t>& stamps) {
  std::vector<double> steps;
  std::size_t zeros = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    std::int64_t step = 0;
    if (__builtin_sub_overflow(stamps[i], stamps[i - 1], &step)) continue;
    zeros += step == 0;
    if (step > 0) steps.push_back(static_cast<double>(step));
  }
  FirstInterval result;
  if (steps.empty()) return result;
  result.coarse = stamps.size() > 8 && zeros * 4 > stamps.size();
  const double middle = median(steps);
  std::vector<double> scatter;
  for (const double step : steps) scatter.push_back(std::fabs(step - middle));
  const double deviation = 1.4826 * median(scatter);
  double sum = 0;
  std::size_t close = 0;
  for (const double step : steps) {
    if (std::fabs(step - middle) > 0.1 * middle) continue;
    sum += step;
    ++close;
  }
  if (!result.coarse && close * 2 >= steps.size()) {
    result.ns = sum / static_cast<double>(close);
    result.longest_step = 1.5 * result.ns;
    return result;
  }
  // No common step (coarse or jittered stamps): long baselines average it out, unless gaps
  // dominate.
  std::vector<double> slopes;
  const std::size_t half = stamps.size() / 2;
  for (std::size_t i = 0; i + half < stamps.size(); ++i)
    slopes.push_back((static_cast<double>(stamps[i + half]) - static_cast<double>(stamps[i])) /
                     static_cast<double>(half));
  const double slope = median(slopes);
  result.ns = result.coarse || (slope > 0.6 * middle && slope < 1.45 * middle) ? slope : middle;
  if (!(result.ns > 0)) result.ns = middle;
  result.longest_step = std::max(1.5 * result.ns, result.ns + 3 * deviation);
  return result;
}

TimeGrid::TimeGrid(const RowSource& source,
                   const ReadOptions& options,
                   BlockSink& sink,
                   Warnings& warnings)
    : source_(source), options_(options), sink_(sink), warnings_(warnings) {
  const auto instant =
      [](const std::optional<double>& s, std::int64_t otherwise, const char* name) {
        if (!s) return otherwise;
        if (!std::isfinite(*s) || std::fabs(*s) > 9e9)
          throw Error({ErrorKind::usage,
                       "",
                       "",
                       std::string(name) + " is not a time in seconds",
                       shortest(*s),
                       ""});
        return static_cast<std::int64_t>(std::llround(*s * 1e9));
      };
  from_ns_ = instant(options.from_s, 0, "--from");
  to_ns_ = instant(options.to_s, INT64_MAX, "--to");
  if (to_ns_ <= from_ns_)
    throw Error(
        {ErrorKind::usage, "", "", "the window is empty: --to does not lie after --from", "", ""});
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
  const std::size_t ahead = end ? 0 : kAhead;
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
      stamps.push_back(item.block.time_ns[i]);
  const FirstInterval found = first_interval(stamps);
  dt_ = found.ns;
  coarse_ = found.coarse;
  limit_ = static_cast<std::int64_t>(std::min(found.longest_step, 9e18));
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
         "--time-column none --rate HZ ignores the stamps");
  }
  if (coarse_)
    warnings_.add("coarse_stamps",
                  "the clock is too coarse to tell rows apart (many equal stamps): rows are kept "
                  "and spaced evenly");
  begin();
}

// The common case is one comparison a row; a run of regular rows goes to the sink without being
// copied.
void TimeGrid::process_rows(Pending& front, std::size_t count) {
  const std::int64_t* const time = front.block.time_ns.data();
  std::size_t run = front.done;
  const std::size_t stop = front.done + count;
  const std::size_t ahead_base = static_cast<std::size_t>(waiting_);
  for (std::size_t i = front.done; i < stop; ++i) {
    std::int64_t stamp = time[i] + wrap_;
    std::int64_t step = 0;
    const bool overflow = __builtin_sub_overflow(stamp, last_, &step);
    const bool regular = have_last_ && !overflow && step > 0 && step <= limit_;
    if (!regular) {
      emit_rows(front.block, run, i);
      run = i;
      if (decide(front, i, stamp, ahead_base - (i - front.done)) == Verdict::drop) {
        run = i + 1;
        continue;
      }
    } else if (same_ratio_ != 0 || step * 4 < 3 * static_cast<std::int64_t>(dt_)) {
      watch_rate(front, i, static_cast<double>(step) / dt_);
    }
    dropped_in_a_row_ = 0;
    ++index_;
    raw_last_ = time[i] + wrap_;
    last_ = stamp;
    have_last_ = true;
    sketch_.add(index_, stamp);
    if (stamp - first_stamp_ < from_ns_) {
      run = i + 1;
    } else if (stamp - first_stamp_ >= to_ns_) {
      emit_rows(front.block, run, i);
      run = stop;
      window_over_ = true;
      break;
    } else {
      if (!start_ns_) start_ns_ = stamp;
      ++used_;
    }
  }
  emit_rows(front.block, std::min(run, stop), stop);
}

// A row whose stamp is not one regular step behind the last one.
TimeGrid::Verdict TimeGrid::decide(const Pending& front,
                                   std::size_t row,
                                   std::int64_t& stamp,
                                   std::size_t ahead) {
  if (!have_last_) {
    first_stamp_ = stamp;
    return Verdict::keep;
  }
  std::int64_t step = 0;
  if (__builtin_sub_overflow(stamp, last_, &step))
    fail(front,
         row,
         "E0316",
         "wild time stamp: the distance to the row before does not fit 64-bit nanoseconds",
         "remove the row, or --time-column none --rate HZ");
  if (step == 0) {
    if (stamp < raw_last_) return backward(front, row, stamp);
    if (coarse_) return Verdict::keep;
    warnings_.add("duplicate_timestamp",
                  "rows with the stamp of the row before: the first is kept",
                  place(front, row));
    return Verdict::drop;
  }
  if (step < 0) return backward(front, row, stamp);
  watch_rate(front, row, static_cast<double>(step) / dt_);
  const std::int64_t gap = lag(front, row, stamp, ahead);
  if (gap <= 0) {
    // Late, but the rows behind it are not: its stamp is wrong, the row has its place.
    if (static_cast<double>(step) > kWildSteps * dt_)
      fail(front,
           row,
           "E0316",
           fmt::format("wild time stamp: {} s ahead of the rows around it",
                       shortest(static_cast<double>(step) * 1e-9)),
           "remove the row, or --time-column none --rate HZ");
    warnings_.add("late_stamp",
                  "stamps far ahead of the rows behind them: the rows are placed on the grid",
                  place(front, row));
    stamp = last_ + static_cast<std::int64_t>(std::llround(dt_));
    return Verdict::keep;
  }
  if (static_cast<double>(gap) > kLargestGap)
    fail(front,
         row,
         "E0316",
         fmt::format("wild time stamp: {} s after the row before ({} missing samples)",
                     shortest(static_cast<double>(step) * 1e-9),
                     gap),
         "remove the row, --from and --to choose a stretch, --time-column none --rate HZ ignores "
         "the stamps");
  ++gaps_;
  warnings_.add("gap", "gaps in the stamps: the missing samples stay missing", place(front, row));
  // Grid points before the window's start are passed over.
  std::int64_t first = 1;
  const double before = static_cast<double>(last_ - first_stamp_);
  if (before < static_cast<double>(from_ns_))
    first = std::max<std::int64_t>(
        1, static_cast<std::int64_t>(std::ceil((static_cast<double>(from_ns_) - before) / dt_)));
  std::int64_t end = gap;
  if (to_ns_ != INT64_MAX)
    end = std::min<std::int64_t>(
        gap,
        static_cast<std::int64_t>(std::ceil((static_cast<double>(to_ns_) - before) / dt_)) - 1);
  if (end >= first) {
    if (!start_ns_)
      start_ns_ = last_ + static_cast<std::int64_t>(std::llround(static_cast<double>(first) * dt_));
    missing_ += static_cast<std::uint64_t>(end - first + 1);
    emit_missing(static_cast<std::uint64_t>(end - first + 1));
  }
  index_ += gap;
  return Verdict::keep;
}

// Counters of 16 or 32 bits (in the stamps' own unit) that ran over go on; other steps back drop
// the row.
TimeGrid::Verdict TimeGrid::backward(const Pending& front, std::size_t row, std::int64_t& stamp) {
  const std::int64_t unit = std::max<std::int64_t>(1,
                                                   source_.info().time.unit == "ns"   ? 1
                                                   : source_.info().time.unit == "us" ? 1000
                                                   : source_.info().time.unit == "ms" ? 1000000
                                                                                      : 0);
  const std::int64_t raw = stamp - wrap_, before = last_ - wrap_;
  for (const int bits : {16, 32}) {
    const double range = std::ldexp(static_cast<double>(unit), bits);
    if (range > 4e18 || source_.info().time.unit == "s" || raw < 0 || before < 0 ||
        static_cast<double>(before) >= range)
      continue;
    const double step = static_cast<double>(raw - before) + range;
    if (step > 0 && step < 0.5 * range && step < 1000 * dt_) {
      wrap_ += static_cast<std::int64_t>(range);
      stamp += static_cast<std::int64_t>(range);
      warnings_.add("clock_rollover",
                    fmt::format("the {}-bit clock ran over: unwrapped", bits),
                    place(front, row));
      const std::int64_t late =
          stamp - last_ <= limit_
              ? 0
              : static_cast<std::int64_t>(std::llround(static_cast<double>(stamp - last_) / dt_)) -
                    1;
      if (late > 0) {
        ++gaps_;
        missing_ += static_cast<std::uint64_t>(late);
        index_ += late;
        emit_missing(static_cast<std::uint64_t>(late));
      }
      return Verdict::keep;
    }
  }
  if (dropped_in_a_row_ == 0) first_dropped_ = source_.where(front.block, row, front.rows_before);
  if (++dropped_in_a_row_ >= kBackward)
    throw Error({ErrorKind::input,
                 "E0317",
                 first_dropped_,
                 fmt::format("the time steps back here and {} rows do not catch up (concatenated "
                             "logs, or a wild stamp before?)",
                             kBackward),
                 "",
                 "split the file there, --to ends before it, --time-column none --rate HZ ignores "
                 "the stamps"});
  warnings_.add("backward_timestamp",
                "rows whose stamp lies before that of the row before: dropped",
                place(front, row));
  return Verdict::drop;
}

// Missing grid points before this row: how much later than expected it and the rows behind it are.
// A single late row whose followers are on time is no gap.
std::int64_t TimeGrid::lag(const Pending& front,
                           std::size_t row,
                           std::int64_t stamp,
                           std::size_t ahead) const {
  const auto late = [&](std::int64_t t, std::size_t j) {
    return static_cast<double>(t - last_) / dt_ - static_cast<double>(j + 1);
  };
  const double own = late(stamp, 0);
  std::vector<double> lags{own};
  std::size_t item = 0, i = row;
  const Pending* at = &front;
  for (std::size_t j = 1; j < std::min(ahead, kAhead); ++j) {
    if (++i >= at->block.rows) {
      if (++item >= pending_.size()) break;
      at = &pending_[item];
      i = 0;
    }
    std::int64_t t = 0, unused = 0;
    if (__builtin_add_overflow(at->block.time_ns[i], wrap_, &t) ||
        __builtin_sub_overflow(t, last_, &unused) || t <= last_)
      continue;
    lags.push_back(late(t, j));
  }
  std::nth_element(
      lags.begin(), lags.begin() + static_cast<std::ptrdiff_t>(lags.size() / 4), lags.end());
  return static_cast<std::int64_t>(std::llround(std::min(own, lags[lags.size() / 4])));
}

// The same odd step many times in a row is another sampling rate, not gaps.
void TimeGrid::watch_rate(const Pending& front, std::size_t row, double ratio) {
  const bool odd = ratio > 1.25 || ratio < 0.75;
  if (!odd) {
    same_ratio_ = 0;
    last_ratio_ = 1;
    return;
  }
  if (same_ratio_ == 0 || std::fabs(ratio - last_ratio_) > 0.1 * last_ratio_) {
    same_ratio_ = 0;
    last_ratio_ = ratio;
    // The last row at the old distance.
    ratio_place_ = row > 0 ? place(front, row - 1) : end_of_block_;
  }
  if (++same_ratio_ != kRateRun) return;
  warnings_.add(
      "rate_change",
      fmt::format("the sampling rate changes ({:.6g} to {:.6g} Hz): the grid keeps the first",
                  1e9 / dt_,
                  1e9 / (dt_ * ratio)),
      ratio_place_);
}

void TimeGrid::without_stamps(Pending& front) {
  begin();
  const double rate = options_.rate_hz ? *options_.rate_hz : source_.info().time.rate_hz;
  std::size_t from = 0, to = front.block.rows;
  if (options_.from_s || options_.to_s) {
    if (!(rate > 0))
      throw Error({ErrorKind::usage,
                   "",
                   source_.info().file,
                   "--from and --to need a time base, and the log has neither stamps nor a rate",
                   "",
                   "--rate HZ gives it"});
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
  used_ += to > from ? to - from : 0;
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

void TimeGrid::finish(LogInfo& info) {
  process(true);
  begin();
  flush();
  info.rows = rows_;
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
  const double interval = sketch_.interval_ns();
  time.rate_hz = interval > 0 ? 1e9 / interval : 0;
  const auto deviation = sketch_.deviation(interval);
  time.jitter_s = deviation.robust * 1e-9;
  time.max_deviation_s = deviation.largest * 1e-9;
  if (interval > 0 && deviation.robust > 0.1 * interval)
    warnings_.add("jitter",
                  fmt::format("stamps scatter by {:.0f} % of the sampling interval: the samples "
                              "are treated as evenly spaced",
                              100 * deviation.robust / interval));
  const double stamped_s = static_cast<double>(last_ - first_stamp_) * 1e-9;
  const double grid_s = static_cast<double>(index_) * interval * 1e-9;
  if (index_ > 0 && std::abs(grid_s - stamped_s) > 0.01 * stamped_s)
    warnings_.add("uneven_sampling",
                  fmt::format("the stamps span {:.4g} s, the samples at one even rate {:.4g} s: the "
                              "sampling is uneven and times on the axes are off by that",
                              stamped_s,
                              grid_s));
  if (options_.rate_hz && interval > 0 && std::abs(*options_.rate_hz * interval * 1e-9 - 1) > 0.01)
    warnings_.add("rate_ignored",
                  fmt::format("the stamps give {:.6g} Hz; the rate of {:.6g} Hz that was given is not "
                              "used (--time-column none ignores the stamps)",
                              1e9 / interval,
                              *options_.rate_hz));
}

}  // namespace libchar

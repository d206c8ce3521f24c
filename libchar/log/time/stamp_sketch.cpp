#include "libchar/log/time/stamp_sketch.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>

#include "libchar/core/numeric/lanes.hpp"
#include "libchar/core/numeric/median.hpp"

namespace libchar {
namespace {

double median(std::vector<double>& values) { return values.empty() ? 0 : median_in_place(values, Middle::lower); }

struct SteadyLine {
  std::int64_t zero, index;  ///< of the first stamp
  double slope;
};

// AVX2 turns no 64-bit integer into a double; below 2^51 the mantissa of 1.5 2^52 does it, exactly. n is whole fours.
LIBCHAR_LANES void extremes_about_lanes(const SteadyLine& line, const std::int64_t* stamps, std::size_t n, double& low,
                                        double& high) {
  using FourStamps [[gnu::vector_size(32)]] = std::int64_t;
  using FourStampsInMemory [[gnu::vector_size(32), gnu::aligned(8), gnu::may_alias]] = std::int64_t;
  constexpr double kMantissa = 6755399441055744.0;  // 1.5 2^52
  const auto bits = std::bit_cast<std::int64_t>(kMantissa);
  const Four steps = {0, 1, 2, 3};
  Four lows = {low, low, low, low}, highs = {high, high, high, high};
  for (std::size_t i = 0; i < n; i += 4) {
    const FourStamps whole = *reinterpret_cast<const FourStampsInMemory*>(stamps + i);
    const FourStamps shifted = (whole - line.zero) + bits;
    Four d;
    std::memcpy(&d, &shifted, sizeof d);
    const Four r =
        (d - kMantissa) - line.slope * (static_cast<double>(line.index + static_cast<std::int64_t>(i)) + steps);
    lows = r < lows ? r : lows;
    highs = r > highs ? r : highs;
  }
  for (std::size_t lane = 0; lane < 4; ++lane) {
    low = std::min(low, lows[lane]);
    high = std::max(high, highs[lane]);
  }
}
constexpr InLanes<extremes_about_lanes> extremes_about;

}  // namespace

void StampSketch::begin_cell(const Pair& read) {
  if (cells_.empty()) {
    zero_ = read;
    first_stamp_ = read.stamp;
  }
  if (cells_.size() == kCells) thin();
  const Pair pair = from_zero(read);
  cells_.push_back({pair, pair, pair, read.stamp - first_stamp_});
  in_cell_ = per_cell_ - 1;
  low_ = high_ = residual(pair);
}

// Lowest and highest of stamps[i] - first - slope (index + i), four at a time.
void StampSketch::extremes(const std::int64_t* stamps, std::size_t n, const Pair& from, double& low,
                           double& high) const {
  constexpr std::int64_t kLargest = std::int64_t{1} << 51U;
  const std::int64_t first = stamps[0] - zero_.stamp, last = stamps[n - 1] - zero_.stamp;
  std::size_t i = 0;
  // Stamps rise, or the run would not be one.
  if (first > -kLargest && last < kLargest) {
    i = n / 4 * 4;
    extremes_about({zero_.stamp, from.index - zero_.index, slope_}, stamps, i, low, high);
  }
  for (; i < n; ++i) {
    const double r = residual(from_zero({from.index + static_cast<std::int64_t>(i), stamps[i]}));
    low = std::min(low, r);
    high = std::max(high, r);
  }
}

void StampSketch::add_run(std::int64_t index, const std::int64_t* stamps, std::size_t n) {
  while (n > 0) {
    // Most stretches hold no new extreme: two of them are looked for before one by one.
    const auto m = static_cast<std::size_t>(std::min<std::uint64_t>(n, in_cell_));
    double low = low_, high = high_;
    if (m > 0) extremes(stamps, m, {index, stamps[0]}, low, high);
    const bool none = m > 0 && low == low_ && high == high_;
    const std::size_t taken = std::max<std::size_t>(m, 1);
    if (none)
      in_cell_ -= m;
    else
      for (std::size_t i = 0; i < taken; ++i) add(index + static_cast<std::int64_t>(i), stamps[i]);
    index += static_cast<std::int64_t>(taken);
    stamps += taken;
    n -= taken;
  }
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
    slopes.push_back(static_cast<double>(b.stamp - a.stamp) / static_cast<double>(b.index - a.index));
  }
  return median(slopes);
}

double StampSketch::line_ns() const {
  // Rows of one stamp: only the first of them is as late as the others. The very first stamp began before the log.
  std::vector<Pair> rises;
  for (std::size_t i = 1; i < cells_.size(); ++i)
    if (cells_[i].first.stamp > cells_[i - 1].first.stamp) rises.push_back(cells_[i].first);
  const bool told = rises.size() > 1 && 2 * rises.size() < cells_.size();
  if (!told) {
    rises.clear();
    for (const Cell& cell : cells_) rises.push_back(cell.first);
  }
  double index = 0, stamp = 0;
  for (const Pair& pair : rises) {
    index += static_cast<double>(pair.index);
    stamp += static_cast<double>(pair.stamp);
  }
  const auto n = static_cast<double>(rises.size());
  double sum_ky = 0, sum_kk = 0;
  for (const Pair& pair : rises) {
    const double k = static_cast<double>(pair.index) - index / n;
    sum_kk += k * k;
    sum_ky += k * (static_cast<double>(pair.stamp) - stamp / n);
  }
  return sum_kk > 0 ? sum_ky / sum_kk : 0;
}

std::optional<RateChange> StampSketch::rate_change(std::size_t parts) const {
  std::vector<double> index, stamp;
  for (const Cell& cell : std::span(cells_).first(cells_.size() / parts)) {
    index.push_back(static_cast<double>(cell.first.index));
    stamp.push_back(static_cast<double>(cell.first.stamp));
  }
  auto change = find_rate_change(index, stamp);
  if (!change) return change;
  const auto next = std::lower_bound(index.begin(), index.end(), change->row);
  const Cell& near = cells_[static_cast<std::size_t>(next - index.begin())];
  change->row =
      static_cast<double>(near.after_first) - (static_cast<double>(near.first.index) - change->row) * change->after_ns;
  return change;
}

StampSketch::Deviation StampSketch::deviation(double interval) const {
  if (cells_.size() < 3) return {};
  const Pair origin = cells_.front().first;
  const auto off = [&](const Pair& pair) {
    return static_cast<double>(pair.stamp - origin.stamp) - interval * static_cast<double>(pair.index - origin.index);
  };
  std::vector<double> r;
  for (const Cell& cell : cells_) r.push_back(off(cell.first));
  const double centre = median(r);
  Deviation result;
  for (const Cell& cell : cells_)
    result.largest = std::max({result.largest, std::fabs(off(cell.low) - centre), std::fabs(off(cell.high) - centre)});
  std::vector<double> size;
  for (const double value : r) size.push_back(std::fabs(value - centre));
  result.robust = kMadToSd * median(size);
  if (result.robust > 0) return result;
  // More than half of the stamps lie on one tick: the scatter is that of the others.
  std::sort(r.begin(), r.end());
  constexpr double kTenthToNinth = 2.5631;  // of a normal distribution, in standard deviations
  const std::size_t tenth = std::max<std::size_t>(1, r.size() / 10);
  result.robust = (r[r.size() - 1 - tenth] - r[tenth]) / kTenthToNinth;
  return result;
}

}  // namespace libchar

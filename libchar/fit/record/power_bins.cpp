#include "libchar/fit/record/power_bins.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/lanes.hpp"
#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/present.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/fit/detail/record/record_powers.hpp"

namespace libchar {
namespace {

// Spectral lines in squared transform coefficients, and what to leave out because of them. A coefficient is a line when
// it exceeds the local floor by what noise does once in 7e7 coefficients (32 x the floor for a single transform). The
// floor is the median of its neighbourhood over the median of chi-square. A sine of power E (in floors) leaks E/(pi
// d)^2 into the coefficient at distance d whatever its phase, so that the neighbourhood goes as well, out to where the
// leak is 1 % of the floor: d = sqrt(10 E).

struct LineClip {
  std::vector<char> clipped;  ///< one flag a coefficient; empty when none is clipped
  std::uint64_t count = 0;    ///< coefficients left out, times nothing: not weighted by pooling
};

constexpr std::size_t kLowest = 32;
constexpr double kFalseAlarm = 1.54e-8;  // P(chi^2_1 > 32)

LIBCHAR_LANES double largest_lanes(const double* x, std::size_t n) {
  const std::size_t whole = n - n % 4;
  Four top = {};
  for (std::size_t i = 0; i < whole; i += 4) {
    const Four v = LIBCHAR_FOUR(x + i);
    top = v > top ? v : top;
  }
  double out = std::max(std::max(top[0], top[1]), std::max(top[2], top[3]));
  for (std::size_t i = whole; i < n; ++i) out = std::max(out, x[i]);
  return out;
}
constexpr InLanes<largest_lanes> largest;

LIBCHAR_LANES std::int64_t count_below_lanes(const double* x, std::size_t n, double level) {
  std::int64_t count = 0;
  for (std::size_t i = 0; i < n; ++i) count += x[i] < level ? 1 : 0;
  return count;
}
constexpr InLanes<count_below_lanes> count_below;

/// Floor of the coefficients: medians over stretches of an eighth of k, 64 to 2048 coefficients long, joined by
/// straight lines in log-log, so that the slope of flicker and walk within a stretch is not taken for a line. A median
/// is looked for where it is asked for: of most stretches the count of coefficients below a level says enough.
class LocalFloor {
 public:
  LocalFloor(const std::vector<double>& mean, std::size_t first, double chi_median)
      : mean_(&mean), chi_median_(chi_median) {
    for (std::size_t lo = 0; lo < mean.size();) {
      const std::size_t width = std::clamp<std::size_t>((lo + first) / 8, 64, 2048);
      std::size_t hi = std::min(mean.size(), lo + width);
      if (mean.size() - hi < 64) hi = mean.size();
      stretches_.push_back({lo, hi});
      log_k_.push_back(0.5 * std::log(static_cast<double>(lo + first) * static_cast<double>(hi - 1 + first)));
      lo = hi;
    }
  }
  /// Lines between two medians; the first and the last go on to the ends.
  std::size_t pieces() const { return std::max<std::size_t>(1, log_k_.size() - 1); }
  /// First coefficient of the piece after this one.
  std::size_t end_of(std::size_t piece) const { return clamped_whole<std::size_t>(std::exp(log_k_[piece + 1])) + 1; }
  double at(std::size_t piece, std::uint64_t k) {
    const std::size_t next = std::min(piece + 1, log_k_.size() - 1);
    const double low = log_floor(piece), high = log_floor(next);
    const double span = log_k_[next] - log_k_[piece];
    const double share = span > 0 ? (std::log(static_cast<double>(k)) - log_k_[piece]) / span : 0;
    return std::exp(low + share * (high - low));
  }
  /// Is a piece that goes on to no end nowhere below `level`? "No" where counts do not tell.
  bool is_above(std::size_t piece, double level) {
    return piece > 0 && piece + 1 < pieces() && reaches(piece, level) && reaches(piece + 1, level);
  }

 private:
  struct Stretch {
    std::size_t from = 0, to = 0;
    double least = 0;      ///< that its median reaches at least
    double log_floor = 0;  ///< where it is known
    bool known = false;
  };

  // The upper median is not below a value that at most half of the coefficients are below.
  bool reaches(std::size_t index, double level) {
    constexpr double kRounded = 1 + 1e-6;  // logarithms and back
    Stretch& stretch = stretches_[index];
    const double median = level * chi_median_ * kRounded;
    const std::size_t count = stretch.to - stretch.from;
    for (const double value : {1.5 * median, median}) {  // the neighbour may ask for a little more
      if (stretch.least >= median) return true;
      const auto below = count_below(mean_->data() + stretch.from, count, value);
      if (static_cast<std::size_t>(below) <= count / 2) stretch.least = value;
    }
    return stretch.least >= median;
  }

  double log_floor(std::size_t index) {
    Stretch& stretch = stretches_[index];
    if (stretch.known) return stretch.log_floor;
    part_.assign(mean_->begin() + static_cast<std::ptrdiff_t>(stretch.from),
                 mean_->begin() + static_cast<std::ptrdiff_t>(stretch.to));
    stretch.log_floor = std::log(std::max(median_in_place(part_, Middle::upper), 1e-300) / chi_median_);
    stretch.known = true;
    count_work(WorkKind::floor_medians, 1);
    return stretch.log_floor;
  }

  const std::vector<double>* mean_;
  double chi_median_ = 0;
  std::vector<double> log_k_;
  std::vector<Stretch> stretches_;
  std::vector<double> part_;  // scratch
};

/// Median of the coefficients beside one, its nearest left out: near the zeros of a filter, and where the two ends of a
/// smooth record make every second coefficient large, the floor bends faster than its stretches tell.
double median_beside(const std::vector<double>& mean, std::size_t i, std::size_t first) {
  constexpr std::size_t kNearest = 2;
  const std::size_t reach = std::clamp<std::size_t>((first + i) / 64, 16, 128);
  std::vector<double> beside;
  for (std::size_t d = kNearest + 1; d <= kNearest + reach; ++d) {
    if (i >= d) beside.push_back(mean[i - d]);
    if (i + d < mean.size()) beside.push_back(mean[i + d]);
  }
  return beside.empty() ? 0 : median_in_place(beside, Middle::upper);
}

/// Marks a line and what it leaks into.
void clip_around(std::size_t i, double excess, std::size_t first, std::vector<char>& clipped) {
  const double reach =
      std::min({std::sqrt(10 * excess), static_cast<double>(first + i) / 4, static_cast<double>(clipped.size()) / 32});
  const auto distance = static_cast<std::size_t>(std::max(1.0, reach));
  const std::size_t from =
      std::max<std::size_t>(i < distance ? 0 : i - distance, first < kLowest ? kLowest - first : 0);
  const std::size_t to = std::min(clipped.size() - 1, i + distance);
  for (std::size_t j = from; j <= to; ++j) clipped[j] = 1;
}

// `mean[i]` is the mean square of coefficient first + i over `pooled` transforms. Coefficients
// below 32 are never clipped.
LineClip clip_lines(const std::vector<double>& mean, std::size_t first, std::uint64_t pooled) {
  const double dof = static_cast<double>(pooled);
  // Never nearer than 1.5: the floor itself is only that good where the spectrum bends.
  const double limit = std::max(1.5, chi_square_upper_quantile(kFalseAlarm, dof) / dof);
  const double chi_median = chi_square_quantile(0.5, dof) / dof;
  LocalFloor floor(mean, first, chi_median);
  LineClip clip;
  const std::size_t end = first + mean.size();
  std::size_t k = std::max(first, kLowest);
  for (std::size_t piece = 0; piece < floor.pieces(); ++piece) {
    const std::size_t next = piece + 1 < floor.pieces() ? std::min(end, floor.end_of(piece)) : end;
    if (k >= next) continue;
    const double top = largest(mean.data() + (k - first), next - k);
    if (floor.is_above(piece, top / limit)) {
      k = next;
      continue;
    }
    // A power law has its least value at an end: only what exceeds that is looked at closely.
    const double least = std::min(floor.at(piece, k), floor.at(piece, next - 1)) * (1 - 1e-9);
    for (; k < next; ++k) {
      const double power = mean[k - first];
      if (!(power > limit * least)) continue;
      // The median of a short stretch is itself uncertain: five of its standard deviations on top.
      const double width = std::clamp(static_cast<double>(k) / 8, 64.0, 2048.0);
      const double margin = 1 + 5 * std::sqrt(2 / dof / width), here = floor.at(piece, k);
      if (!(power > limit * margin * here)) continue;
      if (!(power > limit * median_beside(mean, k - first, first) / chi_median)) continue;
      if (clip.clipped.empty()) clip.clipped.assign(mean.size(), 0);
      clip_around(k - first, here > 0 ? power / here : 1e6, first, clip.clipped);
    }
  }
  for (const char flag : clip.clipped) clip.count += flag != 0 ? 1 : 0;
  return clip;
}

/// A sine spends the coefficients about its own.
void clip_cycles(const PooledPower& power, LineClip& clip) {
  clip.clipped.resize(power.mean.size(), 0);
  const std::size_t first = detail::in_memory(power.first);
  for (const PooledPower::Cycle& cycle : power.cycles) {
    const auto place = clamped_whole<std::size_t>(std::round(cycle.place));
    for (std::size_t k = std::max(first, place - 1); k <= place + 1; ++k)
      if (k < first + power.mean.size()) clip.clipped[k - first] = 1;
  }
}

/// By frequency.
std::vector<Event> cycles_of(const PooledPower& power, double rate_hz) {
  const double points_s = static_cast<double>(power.spacing) / rate_hz;
  std::vector<Event> out;
  for (const PooledPower::Cycle& cycle : power.cycles) {
    Event& one = out.emplace_back();
    one.kind = EventKind::cycle;
    one.size = cycle.amplitude / std::sqrt(static_cast<double>(power.spacing));
    one.period_s = 2 * static_cast<double>(power.length) * points_s / cycle.place;
    one.phase = cycle.phase;
  }
  std::sort(out.begin(), out.end(), [](const Event& a, const Event& b) { return a.period_s > b.period_s; });
  return out;
}

void append_without_cycles(const PooledPower& power, double rate_hz, ClippedBins& out) {
  PooledPower rest = power;
  rest.mean = power.without_cycles;
  LineClip clip = clip_lines(rest.mean, detail::in_memory(rest.first), rest.pooled);
  out.clipped += clip.count;
  clip_cycles(power, clip);
  append_power_bins(rest, rate_hz, clip.clipped, out.bins);
}

}  // namespace

std::vector<PooledPower> whole_powers(std::span<const double> record, const detail::EndNoise* ends) {
  std::vector<PooledPower> powers;
  if (record.size() >= kSmallestTransform && present_run(record) == record.size()) {
    powers.push_back(record_power(record, 1, 1, record.size(), ends));
    return powers;
  }
  std::vector<double> segment;
  std::uint64_t gap = 0, samples = 0;
  const auto end_segment = [&] {
    if (segment.size() >= kSmallestTransform) powers.push_back(record_power(segment, 1, 1, segment.size(), ends));
    segment.clear();
  };
  while (!record.empty()) {
    const std::size_t run = present_run(record);
    if (run > 0 && gap > std::max(kLongGap, samples / 100)) end_segment();
    gap = run > 0 ? 0 : gap + 1;
    segment.insert(segment.end(), record.begin(), record.begin() + static_cast<std::ptrdiff_t>(run));
    samples += run;
    record = record.subspan(std::max<std::size_t>(run, 1));
  }
  end_segment();
  return powers;
}

std::vector<PowerBin> power_bins(std::span<const PooledPower> powers, double rate_hz) {
  std::vector<PowerBin> bins;
  for (const PooledPower& power : powers) append_power_bins(power, rate_hz, {}, bins);
  return bins;
}

std::vector<PowerBin> power_bins(std::span<const double> record, double rate_hz) {
  return power_bins(whole_powers(record), rate_hz);
}

ClippedBins clipped_power_bins(std::span<const PooledPower> powers, double rate_hz) {
  ClippedBins out;
  std::uint64_t longest = 0;
  for (const PooledPower& power : powers) {
    if (!power.cycles.empty()) {
      append_without_cycles(power, rate_hz, out);
      if (power.length * power.spacing > longest) out.cycles = cycles_of(power, rate_hz);
      longest = std::max(longest, power.length * power.spacing);
      continue;
    }
    const LineClip clip = clip_lines(power.mean, detail::in_memory(power.first), power.pooled);
    out.clipped += clip.count;
    append_power_bins(power, rate_hz, clip.clipped, out.bins);
  }
  if (out.clipped > 0) out.all = power_bins(powers, rate_hz);
  return out;
}

}  // namespace libchar

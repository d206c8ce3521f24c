// A single spike stands out of the three-sample residual e_t = y_t - (y_{t-1} + y_{t+1})/2, from
// which drift and slow noise cancel, with its full height (its neighbours with half of it):
//   |e_t| > 6 s_e  and  |e_t| > |e_{t-1}|, |e_{t+1}|,      s = 1.4826 median|.|
// A run of up to 16 wild rows begins with |y_t - g| > 6 s_d, g the last good sample and s_d of first differences, and
// ends where two samples are back within 3 s_d of g; at the record's ends one side is enough. What does not come back
// is a step, and stays. More than six other wild samples within 32 are a loud stretch, and stay. Under Gaussian noise a
// sample passes 6 s once in 5e8.
//
// Spikes or the noise's own tail? A tail is everywhere: most of what lies beyond 5 s lies just beyond it. Under
// P(size > x) ~ (x/5 s)^-a the logarithms ln(size/5 s) are exponential with mean 1/a (Hill 1975), so that 2.5 * their
// sum exceeds the 97 % quantile of a gamma distribution in at most 3 % of records with a >= 2.5; and at least a third
// lies between 5 s and 6 s (0.42 for a = 3, the t distribution of three degrees of freedom). Spikes are what
// contradicts one of the two. A single spike of less than 20 s contradicts neither: it is one where all other
// differences are Gaussian, in the core and in their variance, and many enough for a tail to show there. Where more
// jumps stay than come back the signal itself jumps (telegraph noise), and short stays are no runs of wild rows.
#include "libchar/fit/signs/spike_cleaner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar {
namespace {

constexpr std::size_t kPlaces = std::size_t{1} << 14U;
constexpr double kSpikeLimit = 6, kSpikeShoulder = 5;  // robust standard deviations
constexpr std::int64_t kLongestRun = 16;
constexpr std::int64_t kSpikeReach = 32;  // samples on either side that a spike is alone in
constexpr std::int64_t kMostOthers = 6;   // samples of other spikes and runs
constexpr double kMostShare = 0.01;
constexpr double kTail = 2.5;              // index of the heaviest tail that is taken for noise
constexpr double kTailShoulder = 1.0 / 3;  // of such a tail at least
constexpr double kTailAlarm = 0.03, kShoulderAlarm = 0.01;
// Standard deviations of ln(far / all) and of ln(near / far) of Gaussian differences, times the root of their count.
constexpr double kAll = 1.7, kCore = 4.6;
constexpr double kSure = 4;             // of such standard deviations
constexpr double kMostOfTails = 2;      // excess of a Gaussian record, in standard deviations
constexpr double kShowsItsTail = 1500;  // differences

/// Robust standard deviation of what is not zero. Zero is what rounding leaves of it.
double spread_of(std::vector<double> size, double largest) {
  std::sort(size.begin(), size.end());
  if (size.size() < 8) return 0;
  const double high = size[size.size() * 9 / 10];
  const double zero = std::max(1e-3 * high, 8 * std::numeric_limits<double>::epsilon() * largest);
  const auto first = std::upper_bound(size.begin(), size.end(), zero);
  const std::ptrdiff_t count = size.end() - first;
  return count < 8 ? 0 : kMadToSd * first[count / 2];
}

void halve(std::vector<double>& values) {
  for (std::size_t i = 0; 2 * i < values.size(); ++i) values[i] = values[2 * i];
  values.resize((values.size() + 1) / 2);
}

/// ln(all / far) in its standard deviations of Gaussian differences.
double excess_of(const detail::CoreSums& sums) { return std::log(sums.all / sums.far) * std::sqrt(sums.count) / kAll; }

bool has_gaussian_core(const detail::CoreSums& sums) {
  constexpr double kFlat = 0.01;
  return std::abs(std::log(sums.near / sums.far)) <= kSure * kCore / std::sqrt(sums.count) + kFlat;
}

}  // namespace

void SpikeScan::push(std::span<const double> samples) {
  // Place t needs the samples t, t+1 and t+2; `samples_` of them are gone.
  const auto sample = [&](std::uint64_t t) {
    return t >= samples_ ? samples[detail::in_memory(t - samples_)] : two_[2 - (samples_ - t)];
  };
  const std::uint64_t end = samples_ + samples.size();
  for (; next_ + 2 < end; next_ += stride_) {
    if (residual_.size() == kPlaces) {
      halve(residual_);
      halve(step_);
      stride_ *= 2;
      next_ = residual_.size() * stride_;
      if (next_ + 2 >= end) break;
    }
    look(sample(next_), sample(next_ + 1), sample(next_ + 2));
  }
  if (samples.size() >= 2) {
    two_[0] = samples[samples.size() - 2];
    two_[1] = samples.back();
  } else if (samples.size() == 1) {
    two_[0] = two_[1];
    two_[1] = samples[0];
  }
  samples_ = end;
}

// A place with a missing sample counts as one with NaN, so that places stay where they are.
void SpikeScan::look(double before, double at, double after) {
  residual_.push_back(std::abs(at - 0.5 * (before + after)));
  step_.push_back(std::abs(after - at));
  if (std::abs(at) > largest_) largest_ = std::abs(at);
}

SpikeScale SpikeScan::scale() const {
  std::vector<double> residual = residual_, step = step_;
  const auto missing = [](double value) { return !std::isfinite(value); };
  std::erase_if(residual, missing);
  std::erase_if(step, missing);
  return {spread_of(std::move(residual), largest_), spread_of(std::move(step), largest_)};
}

SpikeVerdict judge_spikes(const SpikeCount& count) {
  if (count.spikes == 0) return SpikeVerdict::none;
  if (static_cast<double>(count.left_out) > kMostShare * static_cast<double>(count.samples))
    return SpikeVerdict::too_many;
  if (count.steps > count.spikes) return SpikeVerdict::heavy_tails;  // a signal that jumps
  const auto events = static_cast<double>(count.spikes + count.shoulder);
  if (chi_square_tail(2 * kTail * count.log_size, 2 * events) < kTailAlarm) return SpikeVerdict::spikes;
  if (binomial_cdf(static_cast<double>(count.shoulder), events, kTailShoulder) < kShoulderAlarm)
    return SpikeVerdict::spikes;
  const detail::CoreSums& rest = count.without;
  const bool gaussian = count.shoulder == 0 && rest.count > kShowsItsTail && rest.far > 0 && has_gaussian_core(rest) &&
                        excess_of(rest) < kMostOfTails;
  return gaussian ? SpikeVerdict::spikes : SpikeVerdict::heavy_tails;
}

}  // namespace libchar

namespace libchar::detail {
namespace {

/// Counts and squares of magnitudes by size, up to four scales.
class SizeHistogram {
 public:
  explicit SizeHistogram(double scale) : width_(kReach * scale / kBins) {}
  void push(double magnitude) {
    const double place = magnitude / width_;
    if (!(place < kBins)) return;
    Bin& bin = bins_[static_cast<std::size_t>(place)];
    bin.count += 1;
    bin.square += magnitude * magnitude;
  }

  /// Scale² of a Gaussian core: the mean square within `reach` standard deviations over what a Gaussian has there,
  /// 1 - 2 c phi(c) / (2 Phi(c) - 1), repeated with its own result.
  double core_square(double start, double reach) const {
    constexpr int kRounds = 8;
    const double inside = std::erf(reach / std::numbers::sqrt2);
    const double density = std::exp(-0.5 * reach * reach) / std::sqrt(2 * std::numbers::pi);
    const double share = 1 - 2 * reach * density / inside;
    double square = start;
    for (int round = 0; round < kRounds; ++round) {
      const Bin below = up_to(reach * std::sqrt(square));
      if (!(below.count > 0)) return start;
      square = below.square / below.count / share;
    }
    return square;
  }

 private:
  static constexpr std::size_t kBins = 1024;
  static constexpr double kReach = 4;
  struct Bin {
    double count = 0, square = 0;
  };
  Bin up_to(double limit) const {
    const double place = std::min(limit / width_, static_cast<double>(kBins));
    const auto whole = static_cast<std::size_t>(place);
    Bin sum;
    for (std::size_t i = 0; i < whole; ++i) {
      sum.count += bins_[i].count;
      sum.square += bins_[i].square;
    }
    if (whole == kBins) return sum;
    const double part = place - static_cast<double>(whole);
    return {sum.count + part * bins_[whole].count, sum.square + part * bins_[whole].square};
  }

  double width_;
  std::array<Bin, kBins> bins_{};
};

}  // namespace

CoreSums core_sums(std::span<const double> record) {
  constexpr double kQuartile = 0.6744897501960817;
  constexpr std::size_t kForScale = std::size_t{1} << 14U;
  constexpr double kMostHeld = 1.0 / 3;  ///< share of values held: or a grid as coarse as the noise
  constexpr double kStep = 10;           ///< standard deviations from which on a difference is no small outlier
  CoreSums out;
  std::vector<double> some;
  const std::size_t stride = std::max<std::size_t>(1, record.size() / kForScale);
  for (std::size_t t = 1; t < record.size(); t += stride)
    if (const double d = std::abs(record[t] - record[t - 1]); std::isfinite(d)) some.push_back(d);
  const auto held = static_cast<double>(std::count(some.begin(), some.end(), 0.0));
  const bool has_core = held <= kMostHeld * static_cast<double>(some.size());
  const double scale = has_core && !some.empty() ? median_in_place(some, Middle::upper) / kQuartile : 0;
  SizeHistogram sizes(scale > 0 ? scale : 1);
  for (std::size_t t = 1; t < record.size(); ++t) {
    const double d = std::abs(record[t] - record[t - 1]);
    if (!std::isfinite(d)) continue;
    out.count += 1;
    if (!(scale > 0) || d < kStep * scale) out.all += d * d;
    sizes.push(d);
  }
  if (!(scale > 0)) {  // values held or of a coarse grid: they have no core
    out.near = out.far = out.all;
    return out;
  }
  out.near = sizes.core_square(scale * scale, CoreSums::kNear) * out.count;
  out.far = sizes.core_square(scale * scale, CoreSums::kFar) * out.count;
  return out;
}

std::optional<OutlierVariance> outlier_variance(const CoreSums& sums, bool expected) {
  constexpr double kExpected = 0.5;
  if (!(sums.count > 0) || !(sums.far > 0)) return std::nullopt;
  const double excess = excess_of(sums);
  if (!(excess > (expected ? kExpected : kSure)) || !has_gaussian_core(sums)) return std::nullopt;
  return OutlierVariance{(sums.all - sums.far) / sums.count / 2,
                         kAll * sums.far / sums.count / 2 / std::sqrt(sums.count), excess > kSure};
}

}  // namespace libchar::detail

namespace libchar {

std::string spike_sentence(const SpikeCount& count) {
  switch (judge_spikes(count)) {
    case SpikeVerdict::too_many:
      return fmt::format(
          "{} of the samples differ from their neighbours: too many for spikes (at most 1 %), and all were kept.",
          percent_text(static_cast<double>(count.left_out) / static_cast<double>(count.samples)));
    case SpikeVerdict::heavy_tails:
      return fmt::format(
          "{} sample{} beyond six standard deviations, as in heavy-tailed noise or a signal that jumps: not treated as "
          "spikes, and kept.",
          count.left_out, count.left_out == 1 ? "" : "s");
    default:
      return "";
  }
}

std::span<const double> SpikeCleaner::push(std::span<const double> samples) {
  held_.insert(held_.end(), samples.begin(), samples.end());
  ready_.clear();
  examine(false);
  release(false);
  return ready_;
}

std::span<const double> SpikeCleaner::finish() {
  ready_.clear();
  examine(true);
  decide(std::numeric_limits<std::int64_t>::max() / 2);
  release(true);
  return ready_;
}

double SpikeCleaner::residual(std::int64_t t) const {
  if (t - 1 < wild_end_ || t - 1 < base_ || t + 1 >= end()) return 0;
  const double e = std::abs(at(t) - 0.5 * (at(t - 1) + at(t + 1)));
  return std::isfinite(e) ? e : 0;
}

void SpikeCleaner::examine(bool last) {
  if (!started_) {
    if (!last && end() < kLongestRun + kSpikeReach) return;
    started_ = true;
    look_at_start();
  }
  while (last ? now_ < end() : now_ + kLongestRun + 2 < end()) {
    look_at(now_, last);
    decide(now_);
  }
}

// Rows 0 … b are wild when they all lie far from the median of the 32 behind them, and the step to those is wild.
void SpikeCleaner::look_at_start() {
  if (!(scale_.step > 0)) return;
  const double limit = kSpikeLimit * scale_.step;
  const std::int64_t longest = std::min(kLongestRun, end() - kSpikeReach);
  for (std::int64_t count = longest; count >= 1; --count) {
    if (!(std::abs(at(count) - at(count - 1)) > limit)) continue;
    std::vector<double> behind(held_.begin() + static_cast<std::ptrdiff_t>(count),
                               held_.begin() + static_cast<std::ptrdiff_t>(count + kSpikeReach));
    std::erase_if(behind, [](double value) { return !std::isfinite(value); });
    if (behind.size() < 8) continue;
    const double level = median_in_place(behind, Middle::upper);
    bool away = true;
    for (std::int64_t t = 0; t < count; ++t) away &= !(std::abs(at(t) - level) <= limit);
    if (!away || !(std::abs(at(count) - level) <= limit)) continue;
    for (std::int64_t t = 0; t < count; ++t) count_.samples += std::isfinite(at(t));
    found(0, count, std::abs(at(count) - at(count - 1)) / scale_.step);
    now_ = count;
    return;
  }
}

void SpikeCleaner::look_at(std::int64_t t, bool last) {
  ++now_;
  if (!std::isfinite(at(t))) return;
  ++count_.samples;
  if (look_for_run(t, last)) return;
  look_alone(t);
  if (wild_end_ > t) return;
  good_ = at(t);
  has_good_ = true;
}

/// Is sample t, and the one behind it, where the good ones were?
bool SpikeCleaner::back(std::int64_t t) const {
  const double limit = 0.5 * kSpikeLimit * scale_.step;
  if (!(std::abs(at(t) - good_) <= limit)) return false;
  return t + 1 >= end() || !(std::abs(at(t + 1) - good_) > limit);
}

bool SpikeCleaner::look_for_run(std::int64_t t, bool last) {
  const double limit = kSpikeLimit * scale_.step;
  if (!(limit > 0) || !has_good_ || !(std::abs(at(t) - good_) > limit)) return false;
  const std::int64_t stop = std::min(t + kLongestRun + 1, end());
  std::int64_t until = t + 1;
  while (until < stop && !back(until)) ++until;
  const bool to_the_end = until == stop && last && stop == end() && until - t <= kLongestRun;
  if (until == stop && !to_the_end) {
    ++count_.steps;
    return false;
  }
  double size = std::abs(at(t) - good_);
  if (!to_the_end) size = std::min(size, std::abs(at(until) - at(until - 1)));
  size /= scale_.step;
  if (until == t + 1 && residual(t) > 0 && scale_.residual > 0) size = residual(t) / scale_.residual;
  if (!(size > kSpikeLimit)) return false;
  for (std::int64_t i = t + 1; i < until; ++i) count_.samples += std::isfinite(at(i));
  found(t, until, size);
  now_ = until;
  return true;
}

void SpikeCleaner::look_alone(std::int64_t t) {
  if (!(scale_.residual > 0)) return;
  const double e = residual(t);
  if (!(e > kSpikeShoulder * scale_.residual) || residual(t - 1) >= e || residual(t + 1) > e) return;
  // Beside a step or a run one neighbour is as near as the other is far.
  const double up = at(t) - at(t - 1), down = at(t) - at(t + 1);
  if (!(up * down > 0) || std::min(std::abs(up), std::abs(down)) < 0.5 * e) return;
  const double size = e / scale_.residual;
  if (size > kSpikeLimit)
    found(t, t + 1, size);
  else
    events_.push_back({t, t + 1, size, false});
}

void SpikeCleaner::found(std::int64_t first, std::int64_t end, double size) {
  events_.push_back({first, end, size, false});
  wild_end_ = end;
}

/// Decides on the events whose surroundings are known when `now` samples have been examined.
void SpikeCleaner::decide(std::int64_t now) {
  for (std::size_t i = 0; i < events_.size(); ++i) {
    Event& event = events_[i];
    if (event.decided) continue;
    if (event.end + kSpikeReach > now) break;
    event.decided = true;
    std::int64_t others = 0;
    for (const Event& other : events_)
      if (&other != &event && other.end > event.first - kSpikeReach && other.first < event.end + kSpikeReach)
        others += other.end - other.first;
    const bool beyond = event.size > kSpikeLimit;
    if (others > kMostOthers) {
      count_.crowded += beyond;
      continue;
    }
    (beyond ? count_.spikes : count_.shoulder) += 1;
    count_.log_size += std::log(event.size / kSpikeShoulder);
    if (!beyond) continue;
    for (std::int64_t t = event.first; t < event.end; ++t) {
      double& sample = held_[static_cast<std::size_t>(t - base_)];
      count_.left_out += std::isfinite(sample);
      sample = std::numeric_limits<double>::quiet_NaN();
    }
  }
  while (!events_.empty() && events_.front().decided && events_.front().end + 2 * kSpikeReach < now)
    events_.pop_front();
}

void SpikeCleaner::release(bool last) {
  std::int64_t until = last ? end() : now_;
  for (const Event& event : events_)
    if (!event.decided) until = std::min(until, event.first);
  for (; given_ < until; ++given_) ready_.push_back(at(given_));
  // Two samples before the next one to be examined are its neighbours.
  const std::int64_t keep = std::max(base_, std::min(given_, now_ - 2));
  held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(keep - base_));
  base_ = keep;
}

std::vector<double> cleaned_record(std::span<const double> record, SpikeCount& count) {
  SpikeScan scan;
  scan.push(record);
  SpikeCleaner cleaner(scan.scale());
  std::vector<double> cleaned;
  cleaned.reserve(record.size());
  const auto keep = [&](std::span<const double> certain) {
    cleaned.insert(cleaned.end(), certain.begin(), certain.end());
  };
  constexpr std::size_t kPiece = 8192;
  for (std::size_t from = 0; from < record.size(); from += kPiece)
    keep(cleaner.push(record.subspan(from, std::min(kPiece, record.size() - from))));
  keep(cleaner.finish());
  count = cleaner.count();
  count.with = core_sums(record);
  count.without = count.left_out > 0 ? core_sums(cleaned) : count.with;
  return cleaned;
}

}  // namespace libchar

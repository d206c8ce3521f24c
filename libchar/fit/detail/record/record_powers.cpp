#include "libchar/fit/detail/record/record_powers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "libchar/core/noise_terms.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/fit/detail/record/cycles.hpp"
#include "libchar/fit/detail/record/dct_means.hpp"
#include "libchar/fit/detail/record/ends.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {

namespace {

constexpr std::uint64_t kSingleBins = 24, kBinsPerOctave = 8;
constexpr std::uint64_t kExactBelow =
    4096;  ///< shorter records get the exact flicker means (beyond, the limit is good to 6e-5)

/// Share of the events' energy below which the noise beside it is not looked at.
constexpr double kLeastNoise = 0.05;

/// A coefficient that lost more than this share with the ends says next to nothing.
constexpr double kMostWithEnds = 0.5;

/// First coefficient of the bin after the one that starts at k.
std::uint64_t next_edge(std::uint64_t k) {
  if (k < kSingleBins) return k + 1;
  const double position = std::log2(static_cast<double>(k) / kSingleBins) * kBinsPerOctave;
  const double edge = kSingleBins * std::exp2((std::floor(position + 1e-9) + 1) / kBinsPerOctave);
  return std::max(k + 1, clamped_whole<std::uint64_t>(std::round(edge)));
}

using Unit = std::array<double, kTerms>;

/// Adds `weight` times the mean of unit(k), k = lo..hi-1, to the sum: by Gauss-Legendre where it is smooth and wide.
template <typename UnitAt>
void add_run(std::uint64_t lo, std::uint64_t hi, double weight, bool smooth, UnitAt&& unit_at, Unit& sum) {
  static constexpr std::array<double, 4> node = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                                 0.9602898564975363};
  static constexpr std::array<double, 4> share = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                                  0.1012285362903763};
  const auto add = [&](double k, double w) {
    const Unit unit = unit_at(k);
    for (std::size_t i = 0; i < kTerms; ++i) sum[i] += w * unit[i];
  };
  if (!smooth || hi - lo <= 64) {
    const double each = weight / static_cast<double>(hi - lo);
    for (std::uint64_t k = lo; k < hi; ++k) add(static_cast<double>(k), each);
    return;
  }
  const double middle = 0.5 * static_cast<double>(lo + hi - 1), half = 0.5 * static_cast<double>(hi - lo);
  for (std::size_t i = 0; i < node.size(); ++i) {
    // An irrational shift keeps the nodes off the integers, where the ramp's odd-even pattern would bite.
    add(middle + half * node[i] + 1e-7, 0.5 * share[i] * weight);
    add(middle - half * node[i] + 1e-7, 0.5 * share[i] * weight);
  }
}

/// Mean of unit(k) over the `kept` coefficients of lo..hi-1, run by run of those that were not clipped.
template <typename UnitAt>
Unit average_unit(std::uint64_t lo, std::uint64_t hi, const std::vector<char>& clipped, std::uint64_t first,
                  std::uint64_t kept, bool smooth, UnitAt&& unit_at) {
  Unit sum{};
  const auto is_clipped = [&](std::uint64_t k) {
    return !clipped.empty() && clipped[detail::in_memory(k - first)] != 0;
  };
  for (std::uint64_t from = lo, to = lo; from < hi; from = to + 1) {
    for (to = from; to < hi && !is_clipped(to);) ++to;
    if (to > from) add_run(from, to, static_cast<double>(to - from) / static_cast<double>(kept), smooth, unit_at, sum);
  }
  return sum;
}

template <typename UnitAt>
void append_bins_of(const PooledPower& power, double rate_hz, const std::vector<char>& clipped, bool smooth,
                    UnitAt&& unit_at, std::vector<PowerBin>& bins) {
  const double step_hz = rate_hz / static_cast<double>(power.spacing) / (2 * static_cast<double>(power.length));
  const std::uint64_t end = power.first + power.mean.size();
  for (std::uint64_t lo = power.first, hi = 0; lo < end; lo = hi) {
    hi = std::min(end, next_edge(lo));
    if (end - hi < (hi - lo) / 4) hi = end;  // no sliver at the end
    double sum = 0, of_events = 0, with_ends = 0;
    std::uint64_t kept = 0;
    for (std::size_t k = detail::in_memory(lo); k < hi; ++k) {
      const std::size_t at = k - detail::in_memory(power.first);
      if (!clipped.empty() && clipped[at] != 0) continue;
      const double gone = k < power.with_ends.size() ? power.with_ends[k] : 0;
      if (gone > kMostWithEnds) continue;
      sum += power.mean[at] / (1 - gone);
      if (!power.of_events.empty()) of_events += power.of_events[at];
      with_ends += gone;
      ++kept;
    }
    const double noise = sum - of_events;
    const bool loud = of_events > 0 && !(noise > kLeastNoise * of_events);
    if (kept == 0 || loud) continue;
    PowerBin bin;
    bin.low_hz = (static_cast<double>(lo) - 0.5) * step_hz;
    bin.high_hz = (static_cast<double>(hi) - 0.5) * step_hz;
    bin.frequency_hz = hi - lo == 1 ? static_cast<double>(lo) * step_hz : std::sqrt(bin.low_hz * bin.high_hz);
    bin.energy = noise / static_cast<double>(kept);
    // sum (n_k + e_k)² - e_k²: the variance of n_k² is 2 P², that of 2 n_k e_k is 4 P e_k².
    const double wider = of_events > 0 ? 1 + 2 * of_events / noise : 1;
    bin.dof = (static_cast<double>(kept * power.pooled) - with_ends) / wider;
    bin.first = lo;
    bin.end = hi;
    bin.length = power.length;
    bin.spacing = power.spacing;
    bin.unit = average_unit(lo, hi, clipped, power.first, kept, smooth, unit_at);
    bins.push_back(bin);
  }
}

}  // namespace

void append_power_bins(const PooledPower& power, double rate_hz, const std::vector<char>& clipped,
                       std::vector<PowerBin>& bins) {
  const double dt_s = 1 / rate_hz;
  const auto without_ends = [&](double k, Unit unit) {
    if (!power.with_ends.empty())
      unit[static_cast<std::size_t>(Term::quantization)] = detail::quantization_without_ends(k, power.length, dt_s);
    return unit;
  };
  if (power.spacing > 1 || power.length <= kExactBelow) {
    const BlockMeanDct exact(power.length, power.spacing, dt_s);
    append_bins_of(
        power, rate_hz, clipped, false,
        [&](double k) { return without_ends(k, exact.mean(static_cast<std::uint64_t>(k))); }, bins);
  } else {
    append_bins_of(
        power, rate_hz, clipped, true, [&](double k) { return without_ends(k, dct_mean(k, power.length, dt_s)); },
        bins);
  }
}

namespace {

/// Between the last coefficient of a block that is left and the first that is not, per point.
double split(std::uint64_t block) { return (static_cast<double>(kLeftToMeans) - 0.5) / static_cast<double>(block); }

}  // namespace

std::uint64_t first_kept(std::uint64_t length, std::uint64_t block) {
  return std::max<std::uint64_t>(1,
                                 clamped_whole<std::uint64_t>(std::ceil(split(block) * static_cast<double>(length))));
}

std::uint64_t end_of_left(std::uint64_t points, std::uint64_t per_mean, std::uint64_t block) {
  const auto last = static_cast<std::uint64_t>(split(block) * static_cast<double>(points * per_mean));
  return std::min(last + 1, points);
}

PooledPower record_power(std::span<const double> points, std::uint64_t spacing, std::uint64_t first, std::uint64_t end,
                         const detail::EndNoise* ends) {
  PooledPower power{points.size(), spacing, first, 1, {}};
  Dct plan(points.size());
  std::span<const double> c = plan.transform(points);
  std::vector<double> without_ends;
  if (ends != nullptr) {
    without_ends.assign(c.begin(), c.end());
    power.with_ends = detail::take_out_ends(without_ends, *ends);
    c = without_ends;
  }
  const std::size_t from = detail::in_memory(first), to = detail::in_memory(end);
  power.mean.reserve(to > from ? to - from : 0);
  for (std::size_t k = from; k < to; ++k) power.mean.push_back(c[k] * c[k]);
  if (first > 1 || power.mean.empty()) return power;
  const auto reach = static_cast<std::ptrdiff_t>(std::min(points.size(), detail::kCycleReach));
  std::vector<double> head(c.begin(), c.begin() + reach);
  power.cycles = detail::take_out_cycles(head, points.size());
  if (power.cycles.empty()) return power;
  power.without_cycles = power.mean;
  for (std::size_t k = from; k < std::min(to, head.size()); ++k) power.without_cycles[k - from] = head[k] * head[k];
  return power;
}

void append_pooled(const PooledSums& sums, std::uint64_t length, std::uint64_t spacing, std::uint64_t first,
                   std::vector<PooledPower>& out) {
  if (sums.transforms == 0) return;
  PooledPower pooled{length, spacing, first, sums.transforms, {}};
  for (std::size_t k = detail::in_memory(first); k < sums.power.size(); ++k)
    pooled.mean.push_back(sums.power[k] / static_cast<double>(sums.transforms));
  if (!pooled.mean.empty()) out.push_back(std::move(pooled));
}

}  // namespace libchar

// Squared DCT-II coefficients as log bins. A record of at most `block` samples: one DCT, k = 1..N-1
// (exact). A longer one:
//   above f_split = 15.5/(2 block dt):  DCT of each block, pooled over blocks, k >= 16, and of the tail;
//   below f_split:                      DCT of the series of means of block/64 samples over the whole
//                                       segment.
// Both levels use their exact expectations (dct_means). Sixteen coefficients of every block are
// left to the second level, so that neighbouring blocks stay uncorrelated under flicker and walk
// and the slow noise is seen with the full resolution of the segment; white noise is exactly
// uncorrelated within each level. Memory: two blocks and 64 means per block.
#include "libchar/fit/power_bins.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "libchar/core/error.hpp"
#include "libchar/core/lanes.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/present.hpp"
#include "libchar/fit/detail/dct_means.hpp"
#include "libchar/fit/detail/line_clip.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kLeftToMeans =
    16;  ///< coefficients of a block that the series of means covers
constexpr std::uint64_t kMeansPerBlock = 64;
constexpr std::uint64_t kSmallest = 8;  ///< shorter segments carry nothing worth their edge effects
constexpr std::uint64_t kSingles = 24, kPerOctave = 8;
constexpr std::uint64_t kExactBelow =
    4096;  ///< shorter records get the exact flicker means (beyond, the limit is good to 6e-5)
constexpr std::uint64_t kLongGap = 4096;  ///< shorter gaps are closed up

/// Mean squared coefficients k = first.. of one transform length, pooled over `pooled` transforms.
struct Power {
  std::uint64_t length = 0;   ///< points of the transform
  std::uint64_t spacing = 1;  ///< samples averaged in a point
  std::uint64_t first = 1;
  std::uint64_t pooled = 1;
  std::vector<double> mean;
};

/// First coefficient of the bin after the one that starts at k.
std::uint64_t next_edge(std::uint64_t k) {
  if (k < kSingles) return k + 1;
  const double position = std::log2(static_cast<double>(k) / kSingles) * kPerOctave;
  const double edge = kSingles * std::exp2((std::floor(position + 1e-9) + 1) / kPerOctave);
  return std::max(k + 1, static_cast<std::uint64_t>(std::llround(edge)));
}

using Unit = std::array<double, kTerms>;

/// Mean of unit(k) over the kept coefficients lo..hi-1; a wide bin without clipped coefficients by
/// Gauss-Legendre over k.
template <typename UnitAt>
Unit average_unit(std::uint64_t lo,
                  std::uint64_t hi,
                  const std::vector<char>& clipped,
                  std::uint64_t first,
                  bool smooth,
                  UnitAt&& unit_at) {
  static constexpr std::array<double, 4> node = {
      0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
  static constexpr std::array<double, 4> weight = {
      0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
  Unit sum{};
  const auto add = [&](double k, double w) {
    const Unit unit = unit_at(k);
    for (std::size_t i = 0; i < kTerms; ++i) sum[i] += w * unit[i];
  };
  if (smooth && hi - lo > 64) {
    const double middle = 0.5 * static_cast<double>(lo + hi - 1),
                 half = 0.5 * static_cast<double>(hi - lo);
    for (std::size_t i = 0; i < node.size(); ++i) {
      // An irrational shift keeps the nodes off the integers, where the ramp's odd-even pattern
      // would bite.
      add(middle + half * node[i] + 1e-7, 0.5 * weight[i]);
      add(middle - half * node[i] + 1e-7, 0.5 * weight[i]);
    }
    return sum;
  }
  double kept = 0;
  for (std::uint64_t k = lo; k < hi; ++k)
    kept += clipped.empty() || clipped[k - first] == 0 ? 1 : 0;
  for (std::uint64_t k = lo; k < hi; ++k) {
    if (clipped.empty() || clipped[k - first] == 0) add(static_cast<double>(k), 1 / kept);
  }
  return sum;
}

template <typename UnitAt>
void append_bins(const Power& power,
                 double rate_hz,
                 const std::vector<char>& clipped,
                 bool smooth,
                 UnitAt&& unit_at,
                 std::vector<PowerBin>& bins) {
  const double step_hz =
      rate_hz / static_cast<double>(power.spacing) / (2 * static_cast<double>(power.length));
  const std::uint64_t end = power.first + power.mean.size();
  for (std::uint64_t lo = power.first, hi = 0; lo < end; lo = hi) {
    hi = std::min(end, next_edge(lo));
    if (end - hi < (hi - lo) / 4) hi = end;  // no sliver at the end
    double sum = 0;
    std::uint64_t kept = 0;
    for (std::uint64_t k = lo; k < hi; ++k) {
      if (!clipped.empty() && clipped[k - power.first] != 0) continue;
      sum += power.mean[k - power.first];
      ++kept;
    }
    if (kept == 0) continue;
    PowerBin bin;
    bin.low_hz = (static_cast<double>(lo) - 0.5) * step_hz;
    bin.high_hz = (static_cast<double>(hi) - 0.5) * step_hz;
    bin.frequency_hz =
        hi - lo == 1 ? static_cast<double>(lo) * step_hz : std::sqrt(bin.low_hz * bin.high_hz);
    bin.energy = sum / static_cast<double>(kept);
    bin.dof = static_cast<double>(kept * power.pooled);
    bin.unit = average_unit(lo, hi, clipped, power.first, smooth && kept == hi - lo, unit_at);
    bins.push_back(bin);
  }
}

void append_bins(const Power& power,
                 double rate_hz,
                 const std::vector<char>& clipped,
                 std::vector<PowerBin>& bins) {
  const double dt_s = 1 / rate_hz;
  if (power.spacing > 1 || power.length <= kExactBelow) {
    const BlockMeanDct exact(power.length, power.spacing, dt_s);
    append_bins(
        power,
        rate_hz,
        clipped,
        false,
        [&](double k) { return exact.mean(static_cast<std::uint64_t>(k)); },
        bins);
  } else {
    append_bins(
        power,
        rate_hz,
        clipped,
        true,
        [&](double k) { return dct_mean(k, power.length, dt_s); },
        bins);
  }
}

Power transform(std::span<const double> points,
                std::uint64_t spacing,
                std::uint64_t first,
                std::uint64_t end,
                Dct* plan) {
  Power power{points.size(), spacing, first, 1, {}};
  std::optional<Dct> own;
  if (plan == nullptr) plan = &own.emplace(points.size());
  const std::span<const double> c = plan->transform(points);
  for (std::uint64_t k = first; k < end; ++k) power.mean.push_back(c[k] * c[k]);
  return power;
}

}  // namespace

namespace {

/// Whole eights of samples less `shift` into eight sums; how many samples that were.
LIBCHAR_WIDE_LANES std::size_t add_eights(const double* x,
                                          std::size_t n,
                                          double shift,
                                          double* sums) {
  Four low = LIBCHAR_FOUR(sums), high = LIBCHAR_FOUR(sums + 4);
  std::size_t i = 0;
  for (; i + 8 <= n; i += 8) {
    low += LIBCHAR_FOUR(x + i) - shift;
    high += LIBCHAR_FOUR(x + i + 4) - shift;
  }
  LIBCHAR_FOUR_TO(sums) = low;
  LIBCHAR_FOUR_TO(sums + 4) = high;
  return i;
}

}  // namespace

struct PowerBinner::State {
  std::uint64_t block, per_mean;
  std::optional<Dct> plan;
  std::vector<double> pending;       ///< samples of the block being filled
  std::vector<double> block_power;   ///< sums of c_k^2 over the blocks transformed here
  std::vector<double> taken_power;   ///< the same over those transformed elsewhere
  std::uint64_t blocks = 0;          ///< whole blocks of all segments
  std::uint64_t segment_blocks = 0;  ///< whole blocks of the current segment
  /// sqrt(per_mean) * mean of per_mean samples, less the segment's first sample
  std::vector<double> means;
  double shift = 0;                 ///< first sample of the segment
  std::array<double, 8> partial{};  ///< sums of the mean being filled
  std::uint64_t partial_count = 0, segment_samples = 0, samples = 0, gap = 0;
  std::vector<Power> done;  ///< of finished segments (their tails and series of means)

  explicit State(std::uint64_t size)
      : block(size), per_mean(std::max<std::uint64_t>(1, size / kMeansPerBlock)) {
    pending.reserve(std::min<std::uint64_t>(block, 1U << 16U));
  }

  void push(std::span<const double> values) {
    while (!values.empty()) {
      if (std::isnan(values[0])) {
        ++gap;
        values = values.subspan(1);
        continue;
      }
      begin_run(values[0]);
      const std::size_t run = present_run(values.first(std::min<std::size_t>(
          values.size(), std::min(per_mean - partial_count, block + 1 - pending.size()))));
      push_run(values.first(run));
      values = values.subspan(run);
    }
  }

  /// What a present sample after missing ones, or the first of all, begins.
  void begin_run(double first) {
    if (gap > std::max(kLongGap, samples / 100)) end_segment();
    gap = 0;
    if (segment_samples == 0) shift = first;
  }

  bool take_block(std::span<const double> values) {
    if (values.size() != block || !pending.empty()) return false;
    begin_run(values[0]);
    while (!values.empty()) {
      const std::size_t run = std::min<std::size_t>(values.size(), per_mean - partial_count);
      add_to_mean(values.first(run));
      values = values.subspan(run);
    }
    ++blocks;
    ++segment_blocks;
    return true;
  }

  // Samples without a missing one, at most up to the end of the mean and one beyond the end of the
  // block.
  void push_run(std::span<const double> run) {
    pending.insert(pending.end(), run.begin(), run.end());
    add_to_mean(run);
    // The block is transformed only when a further sample shows that the record is longer than a
    // block.
    if (pending.size() > block) flush_block();
  }

  // At most up to the end of the mean.
  void add_to_mean(std::span<const double> run) {
    // Eight sums, by position in the mean: the bits do not depend on how the samples came.
    std::size_t i = 0;
    for (; i < run.size() && (partial_count + i) % partial.size() != 0; ++i)
      partial[(partial_count + i) % partial.size()] += run[i] - shift;
    i += add_eights(run.data() + i, run.size() - i, shift, partial.data());
    for (std::size_t lane = 0; i < run.size(); ++i, ++lane) partial[lane] += run[i] - shift;
    partial_count += run.size();
    segment_samples += run.size();
    samples += run.size();
    if (partial_count == per_mean) {
      const double sum = ((partial[0] + partial[4]) + (partial[2] + partial[6])) +
                         ((partial[1] + partial[5]) + (partial[3] + partial[7]));
      means.push_back(sum / std::sqrt(static_cast<double>(per_mean)));
      partial.fill(0);
      partial_count = 0;
    }
  }

  void flush_block() {
    if (!plan) {
      plan.emplace(block);
      block_power.assign(block, 0.0);
    }
    const std::span<const double> c = plan->transform({pending.data(), block});
    for (std::uint64_t k = kLeftToMeans; k < block; ++k) block_power[k] += c[k] * c[k];
    ++blocks;
    ++segment_blocks;
    pending.erase(pending.begin(), pending.begin() + static_cast<std::ptrdiff_t>(block));
  }

  /// The current segment's tail and series of means.
  std::vector<Power> segment_powers() const {
    std::vector<Power> powers;
    const std::uint64_t tail = pending.size();
    if (segment_blocks == 0) {
      if (tail >= kSmallest) powers.push_back(transform(pending, 1, 1, tail, nullptr));
      return powers;
    }
    const double split = (static_cast<double>(kLeftToMeans) - 0.5) / static_cast<double>(block);
    const auto first = static_cast<std::uint64_t>(std::ceil(split * static_cast<double>(tail)));
    if (tail >= kSmallest && first < tail) {
      powers.push_back(transform(pending, 1, std::max<std::uint64_t>(1, first), tail, nullptr));
    }
    const auto low =
        static_cast<std::uint64_t>(split * static_cast<double>(means.size() * per_mean));
    powers.push_back(
        transform(means, per_mean, 1, std::min<std::uint64_t>(low + 1, means.size()), nullptr));
    return powers;
  }

  void end_segment() {
    for (Power& power : segment_powers()) done.push_back(std::move(power));
    pending.clear();
    means.clear();
    partial.fill(0);
    partial_count = segment_samples = segment_blocks = 0;
  }

  std::vector<Power> powers() const {
    std::vector<Power> all = done;
    for (Power& power : segment_powers()) all.push_back(std::move(power));
    if (blocks > 0) {
      Power pooled{block, 1, kLeftToMeans, blocks, {}};
      for (std::uint64_t k = kLeftToMeans; k < block; ++k) {
        const double sum =
            (block_power.empty() ? 0 : block_power[k]) + (taken_power.empty() ? 0 : taken_power[k]);
        pooled.mean.push_back(sum / static_cast<double>(blocks));
      }
      all.push_back(std::move(pooled));
    }
    return all;
  }
};

PowerBinner::PowerBinner(std::uint64_t block) {
  // 64 means of at least one sample, of which the lowest quarter of the band is used.
  if (block < kMeansPerBlock) {
    throw Error({ErrorKind::usage,
                 "",
                 "",
                 "the block of the power binner must have at least 64 samples",
                 std::to_string(block),
                 ""});
  }
  state_ = std::make_unique<State>(block);
}
PowerBinner::~PowerBinner() = default;
PowerBinner::PowerBinner(PowerBinner&&) noexcept = default;
PowerBinner& PowerBinner::operator=(PowerBinner&&) noexcept = default;

bool PowerBinner::suits(std::uint64_t block) {
  return block >= 4096 && block <= (std::uint64_t{1} << 16U);
}

void PowerBinner::push(std::span<const double> samples) {
  state_->push(samples);
}

bool PowerBinner::take_block(std::span<const double> samples) {
  return state_->take_block(samples);
}
void PowerBinner::take_power(std::vector<double> power) {
  state_->taken_power = std::move(power);
}

std::vector<PowerBin> PowerBinner::finish(double rate_hz) const {
  std::vector<PowerBin> bins;
  for (const Power& power : state_->powers()) append_bins(power, rate_hz, {}, bins);
  return bins;
}

std::vector<PowerBin> PowerBinner::finish_clipped(double rate_hz, std::uint64_t& clipped) const {
  std::vector<PowerBin> bins;
  clipped = 0;
  for (const Power& power : state_->powers()) {
    const LineClip clip = clip_lines(power.mean, power.first, power.pooled);
    clipped += clip.count;
    append_bins(power, rate_hz, clip.clipped, bins);
  }
  return bins;
}

}  // namespace libchar

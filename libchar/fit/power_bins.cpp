// Squared DCT-II coefficients as log bins. A record of at most `block` samples: one DCT, k = 1..N-1
// (exact). A longer one:
//   above f_split = 15.5/(2 block dt):  DCT of each block, pooled over blocks, k >= 16, and of the tail;
//   below f_split:                      DCT of the series of means of block/64 samples over the whole
//                                       segment; of more than 2^20 of them, the same once more (mean_series.hpp).
// All levels use their exact expectations (dct_means). Sixteen coefficients of every block are
// left to the second level, so that neighbouring blocks stay uncorrelated under flicker and walk
// and the slow noise is seen with the full resolution of the segment; white noise is exactly
// uncorrelated within each level. Memory: two blocks, up to 2^20 means, and one value for 2^18 samples of a longer record.
#include "libchar/fit/power_bins.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "libchar/core/error.hpp"
#include "libchar/core/lanes.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/present.hpp"
#include "libchar/fit/detail/line_clip.hpp"
#include "libchar/fit/detail/mean_series.hpp"
#include "libchar/fit/detail/pooled_power.hpp"
#include "libchar/fit/detail/record_powers.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {
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
  MeanSeries means;                  ///< of per_mean samples, less the segment's first sample
  double shift = 0;                  ///< first sample of the segment
  std::array<double, 8> partial{};   ///< sums of the mean being filled
  std::uint64_t partial_count = 0, segment_samples = 0, samples = 0, gap = 0;
  std::vector<PooledPower> done;  ///< of finished segments (their tails and series of means)

  explicit State(std::uint64_t size)
      : block(size),
        per_mean(std::max<std::uint64_t>(1, size / kMeansPerBlock)),
        means(per_mean, block) {
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
      means.push(sum / std::sqrt(static_cast<double>(per_mean)));
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
  std::vector<PooledPower> segment_powers() const {
    std::vector<PooledPower> powers;
    const std::uint64_t tail = pending.size();
    if (segment_blocks == 0) {
      if (tail >= kSmallestTransform) powers.push_back(record_power(pending, 1, 1, tail));
      return powers;
    }
    const std::uint64_t first = first_kept(tail, block);
    if (tail >= kSmallestTransform && first < tail)
      powers.push_back(record_power(pending, 1, first, tail));
    means.append_to(powers);
    return powers;
  }

  void end_segment() {
    for (PooledPower& power : segment_powers()) done.push_back(std::move(power));
    pending.clear();
    means.clear();
    partial.fill(0);
    partial_count = segment_samples = segment_blocks = 0;
  }

  std::vector<PooledPower> powers() const {
    std::vector<PooledPower> all = done;
    for (PooledPower& power : segment_powers()) all.push_back(std::move(power));
    if (blocks > 0) {
      PooledPower pooled{block, 1, kLeftToMeans, blocks, {}};
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
                 "E0201",
                 "",
                 "the block of the power binner must have at least 64 samples",
                 std::to_string(block),
                 ""});
  }
  state_ = std::make_unique<State>(block);
}
PowerBinner::PowerBinner(std::vector<PooledPower> powers) : PowerBinner() {
  state_->done = std::move(powers);
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
  for (const PooledPower& power : state_->powers()) append_power_bins(power, rate_hz, {}, bins);
  return bins;
}

ClippedBins PowerBinner::finish_clipped(double rate_hz) const {
  ClippedBins out;
  const std::vector<PooledPower> powers = state_->powers();
  for (const PooledPower& power : powers) {
    const LineClip clip = clip_lines(power.mean, power.first, power.pooled);
    out.clipped += clip.count;
    append_power_bins(power, rate_hz, clip.clipped, out.bins);
  }
  if (out.clipped > 0)
    for (const PooledPower& power : powers) append_power_bins(power, rate_hz, {}, out.all);
  return out;
}

}  // namespace libchar

#include "libchar/fit/record/record_sums.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "libchar/core/numeric/present.hpp"
#include "libchar/fit/detail/band/bridge.hpp"
#include "libchar/fit/remedies.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kSettledHeight = 9;  ///< of nodes whose means are settled: 2^29 samples
constexpr std::uint64_t kPerMean = 32;       ///< as many means of a leaf as a search looks at

void join(FittedSums& sums, FittedSums later) {
  libchar::join(sums.allan, later.allan);
  libchar::join(sums.bins, std::move(later.bins));
  sums.means.join(std::move(later.means));
  libchar::join(sums.pieces, later.pieces);
}

void add_count(const SpikeCount& later, SpikeCount& count) {
  count.samples += later.samples;
  count.left_out += later.left_out;
  count.spikes += later.spikes;
  count.shoulder += later.shoulder;
  count.steps += later.steps;
  count.crowded += later.crowded;
  count.log_size += later.log_size;
}

void scale_fitted(FittedSums& sums, double factor) {
  scale(sums.allan, factor);
  scale(sums.bins, factor);
  sums.means.scale(factor);
  for (std::vector<double>& octave : sums.pieces.variance)
    for (double& variance : octave) variance *= factor * factor;
}

void write_fitted(const FittedSums& sums, StateWriter& to) {
  write_state(sums.allan, to);
  write_state(sums.bins, to);
  sums.means.write_state(to);
  write_state(sums.pieces, to);
}

FittedSums read_fitted(StateReader& from) {
  FittedSums sums;
  sums.allan = read_allan_sums(from);
  sums.bins = read_power_sums(from);
  sums.means.read_state(from);
  sums.pieces = read_piece_variances(from);
  return sums;
}

struct RecordStage {
  using Sums = RecordSums;
  void join(RecordSums& sums, RecordSums later) { libchar::join(sums, std::move(later)); }
  void settle(RecordSums& sums, std::uint64_t height, std::uint64_t first_leaf) {
    libchar::settle(sums, height, first_leaf);
  }
};

}  // namespace

FittedSums fitted_sums(std::span<const double> leaf,
                       const LeafKind& kind,
                       const BlockTransforms& blocks,
                       PowerPart* shared) {
  FittedSums sums;
  PowerPart own;
  if (shared == nullptr && !kind.whole) {
    const std::vector<double> filled = kind.bridged ? bridged(leaf) : std::vector<double>();
    own.push(filled.empty() ? leaf : filled);
  } else if (shared == nullptr) {
    blocks.take(leaf, own);
  }
  sums.bins = (shared != nullptr ? *shared : own).finish(kind.last);
  sums.allan = sums_of_pieces(leaf, sums.pieces);
  sums.means = MeanMeter(kPerMean);
  sums.means.push(leaf);
  return sums;
}

void join(RecordSums& sums, RecordSums later) {
  if (sums.cleaned || later.cleaned) {
    if (!sums.cleaned) sums.cleaned = sums.plain;
    join(*sums.cleaned, later.cleaned ? std::move(*later.cleaned) : later.plain);
  }
  join(sums.plain, std::move(later.plain));
  add_count(later.spikes, sums.spikes);
}

void settle(RecordSums& sums, std::uint64_t height, std::uint64_t first_leaf) {
  if (height != kSettledHeight) return;
  settle_means(sums.plain.bins, first_leaf * kLeafSamples);
  if (sums.cleaned) settle_means(sums.cleaned->bins, first_leaf * kLeafSamples);
}

void scale(RecordSums& sums, double factor) {
  scale_fitted(sums.plain, factor);
  if (sums.cleaned) scale_fitted(*sums.cleaned, factor);
}

RecordSums record_sums(std::span<const double> record, bool remedies) {
  const BlockTransforms blocks(PowerPart::kBlock);
  RecordStage stage;
  LeafTree<RecordStage> tree(stage);
  for (std::uint64_t leaf = 0; !record.empty(); ++leaf) {
    const std::span<const double> samples =
        record.first(std::min<std::uint64_t>(record.size(), kLeafSamples));
    record = record.subspan(samples.size());
    const std::size_t missing = count_missing(samples);
    LeafKind kind{record.empty(), remedies, missing == 0};
    RecordSums sums{fitted_sums(samples, kind, blocks), {}, {}};
    sums.spikes.samples = samples.size() - missing;
    kind.whole = false;
    if (remedies && kurtosis_of_differences(samples) > spike_alarm(sums.spikes.samples))
      sums.cleaned = fitted_sums(cleaned_record(samples, sums.spikes), kind, blocks);
    tree.add({0, leaf, std::move(sums)});
  }
  return tree.whole();
}

void write_state(const RecordSums& sums, StateWriter& to) {
  write_fitted(sums.plain, to);
  to.flag(sums.cleaned.has_value());
  if (sums.cleaned) write_fitted(*sums.cleaned, to);
  const SpikeCount& count = sums.spikes;
  for (const std::uint64_t n :
       {count.samples, count.left_out, count.spikes, count.shoulder, count.steps, count.crowded})
    to.number(n);
  to.real(count.log_size);
}

RecordSums read_record_sums(StateReader& from) {
  RecordSums sums;
  sums.plain = read_fitted(from);
  if (from.flag()) sums.cleaned = read_fitted(from);
  SpikeCount& count = sums.spikes;
  for (std::uint64_t* n : {&count.samples,
                           &count.left_out,
                           &count.spikes,
                           &count.shoulder,
                           &count.steps,
                           &count.crowded})
    *n = from.number();
  count.log_size = from.real();
  return sums;
}

}  // namespace libchar

#include "libchar/characterize/detail/leaf.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "libchar/characterize/detail/rate_samples.hpp"
#include "libchar/characterize/stretches.hpp"
#include "libchar/core/present.hpp"
#include "libchar/fit/remedies.hpp"

namespace libchar {
namespace {

AllanSums allan_of(std::span<const double> samples) {
  AllanPyramid pyramid;
  pyramid.push(samples);
  return std::move(pyramid).sums();
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

void write_count(const SpikeCount& count, StateWriter& to) {
  for (const std::uint64_t n :
       {count.samples, count.left_out, count.spikes, count.shoulder, count.steps, count.crowded})
    to.number(n);
  to.real(count.log_size);
}

SpikeCount read_count(StateReader& from) {
  SpikeCount count;
  for (std::uint64_t* n : {&count.samples,
                           &count.left_out,
                           &count.spikes,
                           &count.shoulder,
                           &count.steps,
                           &count.crowded})
    *n = from.number();
  count.log_size = from.real();
  return count;
}

}  // namespace

LeafStage::LeafStage(const CharacterizeOptions& options,
                     WelchWorkspace& workspace,
                     std::uint64_t samples)
    : options_(&options), samples_(samples), spectrum_(options.spectrum, &workspace) {}

ChannelSums LeafStage::take(std::span<const double> samples, bool last) {
  ChannelSums sums;
  sums.quality.push(samples);
  samples = usable_samples(samples, usable_, sums.beyond);
  if (options_->wanted.quality) sums.trace.push(samples);
  samples = rate_samples(samples, *options_, rate_);
  fit_parts(samples, last, sums);
  const ChannelQuality found = sums.quality.finish();
  sums.spikes.samples = found.samples;
  const bool spikes = found.difference_kurtosis > spike_alarm(found.samples);
  if (spikes && options_->fit.remedies && wants_fit()) clean(samples, last, sums);
  return sums;
}

void LeafStage::fit_parts(std::span<const double> samples, bool last, ChannelSums& sums) const {
  PowerPart bins;
  // Blocks of another length are of no use: then the binner transforms its own.
  const bool shares = spectrum_.shared_length() == PowerPart::kBlock && wants_fit();
  if (options_->wanted.spectrum) sums.spectrum = spectrum_.take(samples, shares ? &bins : nullptr);
  if (!wants_fit()) return;
  if (!options_->wanted.spectrum || !shares) bins.push(samples);
  sums.bins = bins.finish(last);
  sums.allan = allan_of(samples);
}

void LeafStage::clean(std::span<const double> samples, bool last, ChannelSums& sums) const {
  SpikeScan scan;
  scan.push(samples);
  SpikeCleaner cleaner(scan.scale());
  std::vector<double> cleaned;
  cleaned.reserve(samples.size());
  const auto take = [&](std::span<const double> certain) {
    cleaned.insert(cleaned.end(), certain.begin(), certain.end());
  };
  take(cleaner.push(samples));
  take(cleaner.finish());
  sums.spikes = cleaner.count();
  PowerPart bins;
  bins.push(cleaned);
  sums.cleaned = FittedSums{allan_of(cleaned), bins.finish(last)};
}

void LeafStage::join(ChannelSums& sums, ChannelSums later) {
  if (sums.cleaned || later.cleaned) {
    if (!sums.cleaned) sums.cleaned = FittedSums{sums.allan, sums.bins};
    if (!later.cleaned) later.cleaned = FittedSums{later.allan, later.bins};
    libchar::join(sums.cleaned->allan, later.cleaned->allan);
    libchar::join(sums.cleaned->bins, std::move(later.cleaned->bins));
  }
  sums.beyond += later.beyond;
  sums.quality.join(later.quality);
  if (options_->wanted.quality) sums.trace.join(std::move(later.trace));
  if (options_->wanted.spectrum) spectrum_.join(sums.spectrum, later.spectrum);
  libchar::join(sums.allan, later.allan);
  libchar::join(sums.bins, std::move(later.bins));
  add_count(later.spikes, sums.spikes);
}

void LeafStage::settle(ChannelSums& sums, std::uint64_t first_leaf) const {
  const std::uint64_t before = first_leaf * kLeafSamples;
  // A log's end that is no whole run stays as it is: its rest is one transform.
  if (!is_long_record(samples_) || samples_ - before < kSettledLeaves * kLeafSamples) return;
  settle_means(sums.bins, before);
  if (sums.cleaned) settle_means(sums.cleaned->bins, before);
}

void LeafStage::write_state(const ChannelSums& sums, StateWriter& to) {
  to.number(sums.beyond);
  sums.quality.write_state(to);
  sums.trace.write_state(to);
  libchar::write_state(sums.allan, to);
  WelchParts::write_state(sums.spectrum, to);
  libchar::write_state(sums.bins, to);
  to.flag(sums.cleaned.has_value());
  if (sums.cleaned) {
    libchar::write_state(sums.cleaned->allan, to);
    libchar::write_state(sums.cleaned->bins, to);
  }
  write_count(sums.spikes, to);
}

ChannelSums LeafStage::read_state(StateReader& from) const {
  ChannelSums sums;
  sums.beyond = from.number();
  sums.quality.read_state(from);
  sums.trace.read_state(from);
  sums.allan = read_allan_sums(from);
  sums.spectrum = spectrum_.read_state(from);
  sums.bins = read_power_sums(from);
  if (from.flag()) {
    sums.cleaned.emplace();
    sums.cleaned->allan = read_allan_sums(from);
    sums.cleaned->bins = read_power_sums(from);
  }
  sums.spikes = read_count(from);
  return sums;
}

}  // namespace libchar

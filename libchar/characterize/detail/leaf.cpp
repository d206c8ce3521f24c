#include "libchar/characterize/detail/leaf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libchar/core/numeric/present.hpp"
#include "libchar/fit/remedies.hpp"

namespace libchar {
namespace {

bool is_wild(double x) { return std::abs(x) > kLargestSample; }

void forget_wild(std::span<double> samples) {
  for (double& x : samples)
    if (is_wild(x)) x = std::numeric_limits<double>::quiet_NaN();
}

void unwrap_by(double period, std::span<double> samples) {
  double before = std::numeric_limits<double>::quiet_NaN(), turns = 0;
  for (double& x : samples) {
    if (std::isnan(x)) continue;
    const double raw = x;
    if (std::abs(raw - before) > period / 2) turns -= std::round((raw - before) / period);
    before = raw;
    x += turns * period;
  }
}

/// What no leaf is asked for must not be refused.
WelchOptions spectrum_in_leaves(const CharacterizeOptions& options) {
  return streamed_spectrum(why_not_in_leaves(options).empty() ? options.spectrum : WelchOptions{});
}

}  // namespace

void difference(std::vector<double>& phase) {
  for (std::size_t t = 1; t < phase.size(); ++t) phase[t - 1] = phase[t] - phase[t - 1];
  if (!phase.empty()) phase.pop_back();
}

std::vector<NoiseType> types_of_rate(std::span<const double> rate, double dt_s) {
  std::vector<double> phase(rate.size() + 1, 0.0);
  for (std::size_t t = 0; t < rate.size(); ++t) phase[t + 1] = phase[t] + rate[t] * dt_s;
  if (std::isnan(phase.back())) return {};
  return lag1_noise_types(phase, dt_s);
}

ValueCensus census_of(const ChannelQuality& quality) {
  if (quality.samples == 0) return {1, 0, 0, 0, 0};
  return {quality.minimum,    quality.maximum, quality.at_minimum,
          quality.at_maximum, quality.repeats, quality.signs.held_times};
}

void SampleMeters::push(std::span<const double> samples) {
  quality.push(samples);
  if (!traces) return;
  if (count_beyond(samples) == 0) return trace.push(samples);
  std::vector<double> usable(samples.begin(), samples.end());
  forget_wild(usable);
  trace.push(usable);
}

WelchOptions streamed_spectrum(WelchOptions options) {
  if (options.segment == 0) options.segment = kStreamedSegment;
  return options;
}

std::string streamed_segment_note() {
  return fmt::format(
      "segments of {} samples: a quarter of a record of more than {} is taken where `segment` asks for N/4",
      kStreamedSegment, kLeafSamples);
}

std::string why_not_in_leaves(const CharacterizeOptions& options) {
  if (!options.wanted.spectrum) return "";
  return WelchParts::why_not(streamed_spectrum(options.spectrum), kLeafSamples);
}

bool spectrum_of_all(const CharacterizeOptions& options) {
  return options.quarter_segments || options.average == SegmentAverage::median ||
         (options.data == SampleKind::phase && !why_not_in_leaves(options).empty());
}

LeafStage::LeafStage(const CharacterizeOptions& options, WelchWorkspace& workspace)
    : options_(&options),
      workspace_(&workspace),
      wants_spectrum_(options.wanted.spectrum && !spectrum_of_all(options) && why_not_in_leaves(options).empty()),
      blocks_(PowerPart::kBlock, &workspace) {}

WelchParts& LeafStage::spectrum() const {
  if (!spectrum_) spectrum_.emplace(spectrum_in_leaves(*options_), workspace_);
  return *spectrum_;
}

void LeafStage::make_rate(std::vector<double>& samples) const {
  forget_wild(samples);
  if (options_->interpolated > 0) detail::forget_lines(samples, options_->interpolated);
  if (options_->frozen > 1) detail::forget_frozen(samples, options_->frozen);
  if (options_->unwrap > 0) unwrap_by(options_->unwrap, samples);
  const double nominal = options_->nominal_frequency;
  if (options_->data == SampleKind::frequency && nominal != 0)
    for (double& f : samples) f = (f - nominal) / nominal;
}

ChannelSums LeafStage::take(std::span<const double> samples, bool last) {
  SampleMeters meters;
  meters.push(samples.first(std::min<std::size_t>(samples.size(), kLeafSamples)));
  return take(samples, last, std::move(meters));
}

ChannelSums LeafStage::take(std::span<const double> samples, bool last, SampleMeters meters) {
  ChannelSums sums;
  sums.meters = std::move(meters);
  const ChannelQuality found = sums.meters.quality.finish();
  const bool as_it_is = options_->data == SampleKind::rate && found.beyond == 0 && options_->frozen <= 1 &&
                        options_->interpolated == 0 && !(options_->unwrap > 0);
  if (!as_it_is) {
    rate_.assign(samples.begin(), samples.end());
    make_rate(rate_);
    samples = rate_;
  }
  if (!is_phase() && options_->wanted.fit) sums.digital = digital_sums(samples, census_of(found), found.missing);
  const bool clean = options_->fit.remedies && wants_fit() && found.difference_kurtosis > spike_alarm(found.samples);
  std::vector<double> cleaned;
  if (clean) cleaned = cleaned_record(samples, sums.record.spikes);
  sums.record.spikes.samples = found.samples;
  if (options_->data == SampleKind::frequency) sums.types = types_of_rate(samples, 1);
  if (is_phase()) {
    for (std::vector<double>* phase : {&cleaned, &rate_}) detail::bridge_phase(*phase);
    sums.types = lag1_noise_types(clean ? cleaned : rate_, 1);
    difference(cleaned);
    difference(rate_);
    samples = rate_;
  }
  PowerPart bins;
  LeafKind kind{last, options_->fit.remedies, found.missing == 0 && !is_phase()};
  // Blocks of another length are of no use.
  const bool shares = wants_spectrum_ && wants_fit() && kind.whole && spectrum().shared_length() == PowerPart::kBlock;
  if (wants_spectrum_) sums.spectrum = spectrum().take(samples, shares ? &bins : nullptr);
  if (!wants_fit()) {
    if (options_->wanted.spectrum) sums.record.plain.means = means_of_leaf(samples);
    return sums;
  }
  sums.record.plain = fitted_sums(samples, kind, blocks_, shares ? &bins : nullptr);
  kind.whole = false;
  if (clean) sums.record.cleaned = fitted_sums(cleaned, kind, blocks_);
  return sums;
}

void LeafStage::join(ChannelSums& sums, ChannelSums later) {
  sums.meters.quality.join(later.meters.quality);
  sums.meters.trace.join(std::move(later.meters.trace));
  if (wants_spectrum_) spectrum().join(sums.spectrum, later.spectrum);
  detail::join(sums.record, std::move(later.record));
  libchar::join(sums.digital, later.digital);
}

void LeafStage::settle(ChannelSums& sums, std::uint64_t height, std::uint64_t first_leaf) const {
  detail::settle(sums.record, height, first_leaf);
}

void LeafStage::write_state(const ChannelSums& sums, StateWriter& to) {
  sums.meters.quality.write_state(to);
  sums.meters.trace.write_state(to);
  to.reals(sums.kept);
  WelchParts::write_state(sums.spectrum, to);
  detail::write_state(sums.record, to);
  libchar::write_state(sums.digital, to);
  to.number(sums.types.size());
  for (const NoiseType& type : sums.types) {
    to.number(type.m);
    to.real(type.alpha);
    to.real(type.estimate);
  }
}

ChannelSums LeafStage::read_state(StateReader& from) const {
  ChannelSums sums;
  sums.meters.quality.read_state(from);
  sums.meters.trace.read_state(from);
  sums.kept = from.reals();
  if (sums.kept.size() > kLeafSamples) from.refuse("the samples of a leaf");
  sums.spectrum = spectrum().read_state(from);
  sums.record = read_record_sums(from);
  sums.digital = read_digital_sums(from);
  sums.types.resize(from.count(24));
  for (NoiseType& type : sums.types) {
    type.m = from.number();
    const double alpha = from.real();
    if (!(std::abs(alpha) < 10)) from.refuse("a noise type");
    type.alpha = static_cast<int>(alpha);
    type.estimate = from.real();
  }
  return sums;
}

}  // namespace libchar

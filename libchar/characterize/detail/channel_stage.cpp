#include "libchar/characterize/detail/channel_stage.hpp"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "libchar/allan/confidence.hpp"
#include "libchar/allan/ten_a_decade.hpp"
#include "libchar/characterize/detail/rate_samples.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/free_memory.hpp"
#include "libchar/core/present.hpp"
#include "libchar/core/text.hpp"
#include "libchar/fit/motion.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "libchar/fit/remedies.hpp"
#include "libchar/fit/shaped_curves.hpp"
#include "libchar/spectrum/log_spectrum.hpp"

namespace libchar {
namespace {

constexpr std::size_t kPlottedBins =
    400;  // enough for a log–log plot, small enough for a page of many channels
constexpr std::size_t kFewestForMotion = 2048;
constexpr std::size_t kLongRecord = std::size_t{1} << 23U;      // whose spectrum may use it up
constexpr std::uint64_t kLongForAll = std::uint64_t{1} << 17U;  // of which every m is asked for

// For intervals when no fit is wanted or possible: white noise alone, from the shortest averaging time.
Mixture white_alone(const AllanCurve& curve) {
  Mixture theta{};
  if (!curve.points.empty())
    theta[0] = curve.points[0].deviation * curve.points[0].deviation * curve.points[0].tau_s;
  return theta;
}

void add_spectrum(ChannelResult& result, const Spectrum& spectrum, const Quantization& grid) {
  tbb::parallel_invoke([&] { result.lines = find_lines(spectrum, 1e-3, grid); },
                       [&] { result.spectrum = log_binned(spectrum, kPlottedBins); });
}

// Octaves of the overlapping deviation: what the streaming form gives.
bool octaves_only(const AllanOptions& allan, DeviationType type) {
  return type == DeviationType::oadev && allan.grid == TauGrid::octave;
}

// A step that the numbers do not allow becomes a sentence in the result; the other steps go on.
template <class Step>
void attempt(ChannelResult& result, std::string_view what, Step&& step) {
  try {
    step();
  } catch (const Error& error) {
    if (error.problem().kind != ErrorKind::numeric) throw;
    result.problems.push_back(fmt::format("no {}: {}", what, error.problem().what));
  }
}

}  // namespace

WelchOptions streamed_spectrum(WelchOptions options) {
  if (options.segment == 0) options.segment = kStreamedSegment;
  return options;
}

std::string what_needs_all_samples(const CharacterizeOptions& options) {
  if (options.data == SampleKind::phase) return "phase data";
  if (!options.temperature.empty()) return "a correction for temperature";
  if (!options.wanted.allan) return "";
  std::vector<DeviationType> types = options.more_types;
  types.insert(types.begin(), options.allan.type);
  for (const DeviationType type : types)
    if (type != DeviationType::oadev) return fmt::format("the deviation {}", name_of(type));
  if (options.allan.grid != TauGrid::octave) return "a curve at other times than octaves";
  return options.full_overlap ? "a curve with full overlap" : "";
}

void ChannelStage::push(std::span<const double> samples) {
  const bool second = streams_ && streams_->cleaner;
  if (!second) quality_.push(samples);
  std::uint64_t beyond = 0;
  samples = usable_samples(samples, usable_, beyond);
  if (!second) beyond_ += beyond;
  if (!second && options_->wanted.quality) trace_.push(samples);
  stream(rate_samples(samples, *options_, fractional_));
}

void ChannelStage::stream(std::span<const double> samples) {
  if (streams_ && streams_->cleaner) {
    push_cleaned(streams_->cleaner->push(samples));
    return;
  }
  samples_ += samples.size();
  if (keeping_) {
    kept_.insert(kept_.end(), samples.begin(), samples.end());
    return;
  }
  if (wants_fit()) streams_->allan.push(samples);
  if (options_->fit.remedies && wants_fit()) streams_->spikes.push(samples);
  if (streams_->blocks) return streams_->spectrum->push(samples, *streams_->blocks);
  if (options_->wanted.spectrum) streams_->spectrum->push(samples);
  if (wants_fit()) streams_->bins.push(samples);
}

void ChannelStage::reserve(std::size_t samples) {
  try {
    kept_.reserve(samples);
  } catch (const std::bad_alloc&) {
    // Where address space is short the record grows as it comes.
  }
}

void ChannelStage::stop_keeping() {
  if (!keeping_) return;
  keeping_ = false;
  streams_ = std::make_unique<ChannelStreams>();
  streams_->spectrum.emplace(streamed_spectrum(options_->spectrum), &workspace_->welch);
  const std::uint64_t shared = streams_->spectrum->shared_length();
  if (options_->wanted.spectrum && wants_fit() && PowerBinner::suits(shared)) {
    streams_->bins = PowerBinner(shared);
    streams_->blocks.emplace(shared, streams_->bins);
  }
  const std::vector<double> kept = std::move(kept_);
  samples_ = 0;
  stream(kept);
}

bool ChannelStage::needs_second_pass() const {
  if (keeping_ || !options_->fit.remedies || !wants_fit()) return false;
  const ChannelQuality quality = quality_.finish();
  return quality.difference_kurtosis > spike_alarm(quality.samples);
}

void ChannelStage::begin_second_pass() {
  streams_->cleaned.emplace(kStreamedBlock);
  streams_->cleaner.emplace(streams_->spikes.scale());
}

void ChannelStage::take_leaves(ChannelSums sums) {
  keeping_ = false;
  quality_ = std::move(sums.quality);
  trace_ = std::move(sums.trace);
  beyond_ = sums.beyond;
  streams_ = std::make_unique<ChannelStreams>();
  streams_->in_leaves = true;
  if (wants_fit()) streams_->allan = AllanPyramid(sums.allan);
  if (wants_fit()) streams_->bins = binner_of(std::move(sums.bins));
  if (options_->wanted.spectrum)
    streams_->spectrum.emplace(streamed_spectrum(options_->spectrum), sums.spectrum);
  if (!sums.cleaned || !needs_second_pass()) return;
  streams_->spikes_found = sums.spikes;
  streams_->cleaned.emplace(binner_of(std::move(sums.cleaned->bins)));
  streams_->cleaned_allan = AllanPyramid(sums.cleaned->allan);
}

void ChannelStage::push_cleaned(std::span<const double> samples) {
  streams_->cleaned->push(samples);
  streams_->cleaned_allan.push(samples);
}

bool ChannelStage::wants_fit() const {
  return options_->wanted.fit || options_->wanted.allan;
}

// The curve that the fit checks itself with, whatever is plotted.
AllanCurve ChannelStage::octaves_of_kept(double rate_hz) const {
  AllanOptions octaves;
  octaves.threads = options_->allan.threads;
  if (kept_.size() <= options_->exact_samples) return allan_deviation(kept_, 1 / rate_hz, octaves);
  return pyramid_deviation(kept_, 1 / rate_hz);
}

AllanCurve ChannelStage::wanted_of_kept(const AllanCurve& octaves,
                                        DeviationType type,
                                        double rate_hz) const {
  const bool is_long = kept_.size() > options_->exact_samples;
  if (octaves_only(options_->allan, type) && !(is_long && options_->full_overlap)) {
    AllanCurve curve = limited(octaves, options_->allan);
    if (options_->ten_a_decade)
      add_ten_a_decade(kept_, options_->allan, options_->exact_samples, curve);
    return curve;
  }
  AllanOptions allan = options_->allan;
  allan.type = type;
  allan.data = DataKind::rate;  // `difference_kept` has differenced phase data
  const bool many_times = (allan.grid == TauGrid::dense && is_long) ||
                          (allan.grid == TauGrid::all && kept_.size() > kLongForAll);
  if (many_times && !options_->full_overlap) allan.stride_divisor = kPyramidStride;
  if (options_->full_overlap) allan.work_a_point = 0;
  return allan_deviation(kept_, 1 / rate_hz, allan);
}

void ChannelStage::add_curves(const AllanCurve& octaves,
                              double rate_hz,
                              ChannelResult& result) const {
  attempt(result, "Allan deviation", [&] {
    result.allan = wanted_of_kept(octaves, options_->allan.type, rate_hz);
  });
  for (const DeviationType type : options_->more_types) {
    result.more_allan.push_back({});
    result.more_allan.back().type = type;
    attempt(result, name_of(type), [&] {
      result.more_allan.back() = wanted_of_kept(octaves, type, rate_hz);
    });
  }
}

// Phase becomes rate. One wild reading would be two wild rates that sum to zero: the phase is
// cleaned, then differenced.
void ChannelStage::difference_kept(double rate_hz) {
  const auto difference = [&](std::vector<double>& phase) {
    for (std::size_t t = 1; t < phase.size(); ++t)
      phase[t - 1] = (phase[t] - phase[t - 1]) * rate_hz;
    if (!phase.empty()) phase.pop_back();
  };
  if (options_->fit.remedies && wants_fit()) despiked_ = without_spikes(kept_);
  noise_types_ = types_of_kept(rate_hz);
  difference(despiked_.samples);
  difference(kept_);
}

// Of a clock: its phase, or the sum of its frequency.
std::vector<NoiseType> ChannelStage::types_of_kept(double rate_hz) const {
  if (!keeping_ || !wants_fit() || options_->data == SampleKind::rate) return {};
  if (options_->data == SampleKind::phase)
    return lag1_noise_types(despiked_.samples.empty() ? kept_ : despiked_.samples, 1 / rate_hz);
  std::vector<double> phase(kept_.size() + 1, 0.0);
  for (std::size_t t = 0; t < kept_.size(); ++t) phase[t + 1] = phase[t] + kept_[t] / rate_hz;
  if (std::isnan(phase.back())) return {};
  return lag1_noise_types(phase, 1 / rate_hz);
}

void ChannelStage::name_noise_types(ChannelResult& result) const {
  result.noise_types = noise_types_;
  if (!result.fit || noise_types_.empty()) return;
  result.fit->sentences.push_back(
      "Noise types by the lag-1 autocorrelation, as Stable32 names them: " +
      noise_types_text(noise_types_) + ".");
}

NoiseFit ChannelStage::fit_of_kept(const AllanCurve& octaves,
                                   double rate_hz,
                                   const std::string& unit) const {
  FitOptions options = options_->fit;
  if (unit != "1") options.unit = unit;  // for sentences: a ratio has none
  options.clock = options_->data != SampleKind::rate;
  // What is fitted of a clock is not what is in the log.
  if (!options.clock) options.difference_kurtosis = found_.difference_kurtosis;
  const bool opinion = !octaves.points.empty();
  const bool cleaned = !despiked_.samples.empty();
  AllanCurve own;
  RecordKnowledge known;
  known.temperature = temperature_.get();
  if (!cleaned) {
    known.series = series_ ? &*series_ : nullptr;
    if (options_->data == SampleKind::rate) known.missing = found_.missing;
  }
  if (cleaned && opinion) own = pyramid_deviation(despiked_.samples, 1 / rate_hz);
  NoiseFit fit = fit_record(cleaned ? despiked_.samples : kept_,
                            rate_hz,
                            opinion ? cleaned ? &own : &octaves : nullptr,
                            options,
                            &workspace_->fit,
                            known);
  add_spike_answer(despiked_.answer, fit);
  return fit;
}

NoiseFit ChannelStage::fit_of_streams(const AllanCurve& octaves, double rate_hz) {
  SpikeAnswer answer;
  AllanCurve cleaned_allan;
  if (streams_->cleaner) {
    push_cleaned(streams_->cleaner->finish());
    streams_->spikes_found = streams_->cleaner->count();
  }
  if (streams_->spikes_found) {
    answer = spike_answer(
        found_.difference_kurtosis, spike_alarm(found_.samples), *streams_->spikes_found);
    cleaned_allan = streams_->cleaned_allan.finish(1 / rate_hz);
  }
  const bool cleaned = answer.remedy.has_value();
  FitOptions options = options_->fit;
  options.clock = options_->data != SampleKind::rate;
  if (!cleaned) options.difference_kurtosis = found_.difference_kurtosis;
  NoiseFit fit = fit_binned(cleaned ? *streams_->cleaned : streams_->bins,
                            rate_hz,
                            found_.samples,
                            octaves.points.empty() ? nullptr
                            : cleaned              ? &cleaned_allan
                                                   : &octaves,
                            options,
                            &workspace_->fit);
  add_spike_answer(answer, fit);
  return fit;
}

// Of the samples as they are in the log; those of other kinds are differences or ratios of them.
Quantization ChannelStage::quantization() const {
  if (options_->data != SampleKind::rate) return {};
  return quantization_of(found_.resolution.value_or(0), found_.difference_sd);
}

// To be fitted, and no clock or counter: the result says which.
bool ChannelStage::is_noise(ChannelResult& result) const {
  if (!wants_fit()) return false;
  if (options_->data == SampleKind::phase) return true;  // the phase of a clock does rise
  if (found_.counter.empty()) return true;
  result.problems.push_back("no noise fit: the channel " + found_.counter);
  return false;
}

// A sensor that moves shows its motion and not its noise: no coefficients of a recording that moves throughout, and a sentence
// where a stretch of it does.
bool ChannelStage::is_at_rest(ChannelResult& result,
                              double rate_hz,
                              std::vector<Interval>& moving_s) {
  if (options_->data != SampleKind::rate || !options_->wanted.fit || !options_->fit.remedies)
    return true;
  // Filled gaps are stiller than any sensor.
  const std::uint64_t missing = found_.missing;
  if (kept_.size() < kFewestForMotion || missing * 100 > kept_.size()) return true;
  series_ = event_series(kept_, rate_hz);
  result.motion = find_motion(*series_);
  for (const std::string& sentence : result.motion.sentences) result.problems.push_back(sentence);
  moving_s = result.motion.moving_s;
  if (result.motion.whole)
    result.problems.push_back("no noise fit: the recording holds a signal throughout");
  return !result.motion.whole;
}

// Of samples as the log has them: those of other kinds are differences or ratios.
void ChannelStage::find_digital(ChannelResult& result, double rate_hz) const {
  if (options_->data != SampleKind::rate || !options_->wanted.fit) return;
  if (found_.samples == 0) return;
  const ValueCensus census{
      found_.minimum, found_.maximum, found_.at_minimum, found_.at_maximum, found_.repeats};
  result.digital =
      find_digital_faults(kept_, census, rate_hz, found_.resolution, result.channel.unit);
  for (const std::string& sentence : result.digital.sentences) result.problems.push_back(sentence);
}

// Curve and fit side by side: both need the record and the octaves.
void ChannelStage::curve_and_fit(ChannelResult& curve, ChannelResult& result, double rate_hz) {
  AllanCurve octaves;
  bool there = false;
  if (wants_fit())
    attempt(curve, "Allan deviation", [&] {
      octaves = octaves_of_kept(rate_hz);
      there = true;
    });
  tbb::parallel_invoke(
      [&] {
        if (there) add_curves(octaves, rate_hz, curve);
      },
      [&] { fit_kept(octaves, rate_hz, result); });
}

// A thread that has no channel of its own left takes a part of another's. Isolated: one that waits for it begins no other channel,
// whose memory would come on top. The spectrum of a long record comes last and uses it up: as much memory as half a record less.
void ChannelStage::finish_kept(ChannelResult& result, double rate_hz) {
  ChannelResult curve, spectrum;
  const std::size_t before = result.problems.size();
  const bool is_long = kept_.size() >= kLongRecord;
  const auto add = [&](const auto& by_welch) {
    if (options_->wanted.spectrum)
      attempt(spectrum, "spectrum", [&] { add_spectrum(spectrum, by_welch(), quantization()); });
  };
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_invoke(
        [&] { curve_and_fit(curve, result, rate_hz); },
        [&] {
          if (is_long) return;
          add([&] { return welch(kept_, rate_hz, options_->spectrum, &workspace_->welch); });
        });
    if (!is_long) return;
    give_back_free_memory();
    add([&] {
      return welch_using_up(std::move(kept_), rate_hz, options_->spectrum, &workspace_->welch);
    });
  });
  result.allan = std::move(curve.allan);
  result.more_allan = std::move(curve.more_allan);
  result.spectrum = std::move(spectrum.spectrum);
  result.lines = std::move(spectrum.lines);
  auto at = result.problems.begin() + static_cast<std::ptrdiff_t>(before);
  at = result.problems.insert(at, curve.problems.begin(), curve.problems.end());
  result.problems.insert(at + static_cast<std::ptrdiff_t>(curve.problems.size()),
                         spectrum.problems.begin(),
                         spectrum.problems.end());
}

void ChannelStage::fit_kept(const AllanCurve& octaves, double rate_hz, ChannelResult& result) {
  if (!is_noise(result)) return;
  find_digital(result, rate_hz);
  attempt(result, "noise fit", [&] {
    std::vector<Interval> moving_s;
    if (!is_at_rest(result, rate_hz, moving_s)) return;
    result.fit = fit_of_kept(octaves, rate_hz, result.channel.unit);
    result.fit->moving_s = std::move(moving_s);
    doubt_digital(result.digital, *result.fit);
  });
}

void ChannelStage::finish_streams(ChannelResult& result, double rate_hz) {
  AllanCurve octaves;
  if (wants_fit())
    attempt(result, "Allan deviation", [&] {
      octaves = streams_->allan.finish(1 / rate_hz);
      result.allan = limited(octaves, options_->allan);
    });
  if (streams_->blocks) streams_->spectrum->end(*streams_->blocks);
  if (options_->wanted.spectrum)
    attempt(result, "spectrum", [&] {
      add_spectrum(result, streams_->spectrum->finish(rate_hz), quantization());
      if (options_->spectrum.segment == 0)
        result.spectrum.notes.push_back(
            fmt::format("segments of {} samples instead of a quarter of the record, which {}",
                        kStreamedSegment,
                        streams_->in_leaves ? "was taken in stretches"
                                            : "does not fit into the memory allowed"));
    });
  if (is_noise(result))
    attempt(result, "noise fit", [&] { result.fit = fit_of_streams(octaves, rate_hz); });
}

// A clock is a few parts in a million off, not a hundredth: else somebody has named the wrong kind of data, or no nominal frequency.
void ChannelStage::doubt_frequency(ChannelResult& result) const {
  constexpr double kMostOff = 0.01;
  if (options_->data != SampleKind::frequency || found_.samples == 0) return;
  const double nominal = options_->nominal_frequency;
  const double off = nominal == 0 ? found_.mean : found_.mean / nominal - 1;
  if (std::abs(off) <= kMostOff) return;
  result.problems.push_back(
      nominal == 0 ? fmt::format("The mean is {:.6g}: without `nominal_frequency` values are taken "
                                 "for fractional frequencies, which are small.",
                                 found_.mean)
                   : fmt::format("The mean, {:.6g}, is far from the nominal frequency of {:.6g}.",
                                 found_.mean,
                                 nominal));
}

// Differenced phase and fractional frequency have other units than the samples in the log.
std::string ChannelStage::unit_of_rate(const std::string& unit) const {
  if (options_->data == SampleKind::phase)
    return unit == "s" ? "1" : unit.empty() ? "" : unit + "/s";
  return options_->data == SampleKind::frequency && options_->nominal_frequency != 0 ? "1" : unit;
}

// The quality in the unit of the rate: what a model is made of. A phase's resolution and range are those of no rate.
ChannelQuality ChannelStage::quality_of_rate() const {
  ChannelQuality quality = found_;
  if (options_->data == SampleKind::phase) {
    quality.resolution = std::nullopt;
    quality.saturated = 0;
  }
  const double nominal = options_->nominal_frequency;
  if (options_->data != SampleKind::frequency || nominal == 0) return quality;
  for (double* value : {&quality.mean, &quality.minimum, &quality.maximum})
    *value = (*value - nominal) / nominal;
  for (double* value : {&quality.standard_deviation, &quality.difference_sd, &quality.float32_step})
    *value /= std::abs(nominal);
  if (quality.resolution) *quality.resolution /= std::abs(nominal);
  return quality;
}

ChannelResult ChannelStage::finish(const Channel& channel, double rate_hz) {
  ChannelResult result;
  result.channel = channel;
  result.channel.unit = unit_of_rate(channel.unit);
  found_ = quality_.finish();
  if (options_->wanted.quality) {
    result.quality = quality_of_rate();
    result.trace = trace_.finish();
    result.trace_unit = channel.unit;
  }
  if (rate_hz <= 0) {
    const std::string why =
        found_.samples < 2
            ? fmt::format("{}, and so no rate", plural(found_.samples, "sample"))
            : "the sampling rate is not known (a log without time stamps needs `rate_hz`)";
    result.problems.push_back("no curves and no fit: " + why);
    return result;
  }
  // Else the quality says so.
  if (beyond_ > 0 && !options_->wanted.quality)
    result.problems.push_back(
        fmt::format("{} beyond {:g} in magnitude: no measurement, taken as missing",
                    plural(beyond_, "sample"),
                    kLargestSample));
  doubt_frequency(result);
  if (options_->data == SampleKind::phase) difference_kept(rate_hz);
  if (options_->data == SampleKind::frequency) noise_types_ = types_of_kept(rate_hz);
  keeping_ ? finish_kept(result, rate_hz) : finish_streams(result, rate_hz);
  name_noise_types(result);
  const auto add_to = [&](AllanCurve& curve) {
    result.fit ? add_fit_intervals(curve, *result.fit)
               : add_intervals(curve, white_alone(result.allan));
  };
  add_to(result.allan);
  for (AllanCurve& curve : result.more_allan) add_to(curve);
  drop();
  despiked_ = {};
  series_.reset();
  return result;
}

}  // namespace libchar

// A record that fits into a leaf is kept and looked at as a whole; a longer one is finished from the sums over its
// leaves. Which of both depends on its length only. What still needs the samples of a longer one
// (`what_needs_all_samples`) changes no coefficient but by a temperature, which is taken out of the samples.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <numbers>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/characterize/detail/channel_stage.hpp"
#include "libchar/characterize/detail/rest_doubt.hpp"
#include "libchar/core/axis_name.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/numeric/present.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/fit/curve/shaped_curves.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "libchar/fit/remedies.hpp"
#include "libchar/fit/signs/motion.hpp"
#include "libchar/fit/signs/rounding.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/spectrum/spectrum.hpp"

namespace libchar {
namespace {

constexpr std::size_t kFewestForMotion = 2048;
constexpr double kClockScatter = 1e-8;  // of the mean: below, values are frequencies or periods as counted
constexpr std::uint64_t kLongForAll = std::uint64_t{1} << 17U;  // of which every m is asked for

// For intervals when no fit is wanted or possible: white noise alone, from the shortest averaging time.
Mixture white_alone(const AllanCurve& curve) {
  Mixture theta{};
  if (!curve.points.empty()) theta[0] = curve.points[0].deviation * curve.points[0].deviation * curve.points[0].tau_s;
  return theta;
}

// Octaves of the overlapping deviation: what the streaming form gives.
bool octaves_only(const AllanOptions& allan, DeviationType type) {
  return type == DeviationType::oadev && allan.grid == TauGrid::octave;
}

// A step that the numbers do not allow becomes a finding of the result; the other steps go on.
template <class Step>
void attempt(ChannelResult& result, std::string_view what, Step&& step, std::string_view code = "not_computed") {
  try {
    step();
  } catch (const Error& error) {
    if (error.problem().kind != ErrorKind::numeric) throw;
    result.findings.push_back(finding(code, fmt::format("no {}: {}", what, error.problem().what)));
  }
}

void add_findings(const std::vector<Finding>& findings, ChannelResult& result) {
  result.findings.insert(result.findings.end(), findings.begin(), findings.end());
}

/// Of a series at most so many means, for what is slow: temperature.
EventSeries coarse(const EventSeries& series) {
  constexpr std::size_t kMost = std::size_t{1} << 14U;  // a cycle of a few periods is lost in 2,000
  return detail::means_of(series, std::max<std::size_t>(1, (series.value.size() + kMost - 1) / kMost));
}

class Finish {
 public:
  Finish(ReadChannel& read, const CharacterizeOptions& options, CharacterizeWorkspace& workspace)
      : read_(read), options_(options), workspace_(workspace) {}

  ChannelResult result(const Channel& channel, const TimeBase& time);

 private:
  // what it is
  bool is_whole() const { return is_whole_; }
  bool is_answered(const Finding& one) const;
  bool wants_fit() const { return options_.wanted.fit || options_.wanted.allan; }
  Quantization quantization() const;
  ChannelQuality quality_of_rate() const;
  std::string unit_of_rate(const std::string& unit) const;
  void make_rate(double rate_hz);
  void scale_sums(double per_s);
  std::vector<NoiseType> noise_types(double rate_hz) const;
  // what is made of it
  void finish(ChannelResult& result, double rate_hz);
  AllanCurve octaves(double rate_hz);
  AllanCurve wanted_curve(const AllanCurve& octaves, DeviationType type, double rate_hz) const;
  void add_curves(const AllanCurve& octaves, double rate_hz, ChannelResult& result) const;
  void curve_and_fit(ChannelResult& curve, ChannelResult& result, double rate_hz);
  void add_spectrum(ChannelResult& result, double rate_hz);
  bool is_noise(ChannelResult& result) const;
  void doubt_unit(ChannelResult& result, double rate_hz) const;
  void doubt_frequency(ChannelResult& result) const;
  void doubt_rate(ChannelResult& result, double rate_hz) const;
  void doubt_rest(ChannelResult& result, double rate_hz) const;
  std::optional<double> white_limit(const Coefficient& walk, double rate_hz) const;
  std::optional<EventSeries> series(double rate_hz) const;
  void find_motion(ChannelResult& result, double rate_hz);
  bool is_at_rest(ChannelResult& result, double rate_hz);
  void find_digital(ChannelResult& result, double rate_hz) const;
  void fit(const AllanCurve& octaves, double rate_hz, ChannelResult& result);
  NoiseFit fit_of_kept(const AllanCurve& octaves, double rate_hz, FitOptions options) const;
  NoiseFit fit_of_sums(const AllanCurve& octaves, double rate_hz, FitOptions options);

  ReadChannel& read_;
  const CharacterizeOptions& options_;
  CharacterizeWorkspace& workspace_;
  ChannelQuality found_;
  bool is_whole_ = false;
  double phase_factor_ = 1;   ///< of its unit, to fractional frequency
  std::vector<double> kept_;  ///< as a rate: all samples, or none
  DespikedRecord despiked_;   ///< rate of the phase without its spikes, when it has some
  std::vector<NoiseType> noise_types_;
  std::vector<AllanPoint> between_;    ///< octaves, for the plot: of the same sums
  std::optional<EventSeries> series_;  ///< where the search for motion has made it
};

// By an option that was given.
bool Finish::is_answered(const Finding& one) const {
  if (one.code == "spiky") return options_.unwrap > 0 || options_.frozen > 1;
  // The phase of a clock that is off in frequency rises by as much with every sample.
  if (one.code == "counter") return options_.data == SampleKind::phase;
  return (options_.unwrap > 0 && one.code == "phase_wraps") || (options_.frozen > 1 && one.code == "stuck") ||
         (options_.frozen == 2 && one.code == "repeated_samples") ||
         (options_.interpolated > 0 && one.code == "interpolated");
}

// Phase becomes rate. One wild reading would be two wild rates that sum to zero: the phase is
// cleaned, then differenced.
void Finish::make_rate(double rate_hz) {
  LeafStage(options_, workspace_.welch).make_rate(kept_);
  if (options_.data != SampleKind::phase) {
    noise_types_ = noise_types(rate_hz);
    return;
  }
  if (options_.fit.remedies && wants_fit() && is_whole()) despiked_ = without_spikes(kept_);
  detail::bridge_phase(despiked_.samples);
  detail::bridge_phase(kept_);
  const double per_s = rate_hz * phase_factor_;
  if (!is_whole()) scale_sums(per_s);
  noise_types_ = noise_types(rate_hz);
  for (std::vector<double>* phase : {&despiked_.samples, &kept_}) {
    difference(*phase);
    for (double& rate : *phase) rate *= per_s;
  }
}

/// Of a phase, whose differences know no rate before the log has been read.
void Finish::scale_sums(double per_s) {
  scale(read_.sums.record, per_s);
  for (double& power : read_.sums.spectrum.power) power *= per_s * per_s;
}

// Of a clock. Of a record of leaves: below the length of its means by the first leaf, from there on
// by the sum of the means.
std::vector<NoiseType> Finish::noise_types(double rate_hz) const {
  if (options_.data == SampleKind::rate || !wants_fit()) return {};
  if (is_whole() && options_.data == SampleKind::frequency) return types_of_rate(kept_, 1 / rate_hz);
  if (is_whole()) return lag1_noise_types(despiked_.samples.empty() ? kept_ : despiked_.samples, 1 / rate_hz);
  const MeanMeter& means = read_.sums.record.plain.means;
  const std::uint64_t per_mean = means.per_mean();
  std::vector<NoiseType> types = read_.sums.types;
  std::erase_if(types, [&](const NoiseType& type) { return type.m >= per_mean; });
  for (NoiseType& type : types) type.tau_s = static_cast<double>(type.m) / rate_hz;
  for (NoiseType type : types_of_rate(means.means(), static_cast<double>(per_mean) / rate_hz)) {
    type.m *= per_mean;
    types.push_back(type);
  }
  return types;
}

// Of the samples as they are in the log; those of other kinds are differences or ratios of them.
Quantization Finish::quantization() const {
  if (options_.data != SampleKind::rate) return {};
  return quantization_of(found_.resolution.value_or(0), found_.difference_sd);
}

// The curve that the fit checks itself with, whatever is plotted.
AllanCurve Finish::octaves(double rate_hz) {
  if (!is_whole()) return octave_curve(read_.sums.record.plain.allan, 1 / rate_hz);
  AllanOptions octaves;
  octaves.threads = options_.allan.threads;
  if (options_.ten_a_decade && octaves_only(options_.allan, options_.allan.type) && count_missing(kept_) == 0)
    octaves.more_factors = detail::exact_factors(options_.allan, 1 / rate_hz, kept_.size());
  AllanCurve curve = allan_deviation(kept_, 1 / rate_hz, octaves);
  std::erase_if(curve.points, [&](const AllanPoint& point) {
    const bool between = !std::has_single_bit(point.m);
    if (between) between_.push_back(point);
    return between;
  });
  return curve;
}

AllanCurve Finish::wanted_curve(const AllanCurve& octaves, DeviationType type, double rate_hz) const {
  if (octaves_only(options_.allan, type) && (is_whole() || !options_.full_overlap)) {
    AllanCurve curve = limited(octaves, options_.allan);
    if (options_.ten_a_decade && is_whole()) add_ten_a_decade(kept_, options_.allan, kLeafSamples, curve, between_);
    return curve;
  }
  AllanOptions allan = options_.allan;
  allan.type = type;
  allan.data = DataKind::rate;  // `make_rate` has differenced phase data
  const bool many_times =
      (allan.grid == TauGrid::dense && !is_whole()) || (allan.grid == TauGrid::all && kept_.size() > kLongForAll);
  if (many_times && !options_.full_overlap) allan.stride_divisor = kPyramidStride;
  if (options_.full_overlap) allan.work_a_point = 0;
  return allan_deviation(kept_, 1 / rate_hz, allan);
}

void Finish::add_curves(const AllanCurve& octaves, double rate_hz, ChannelResult& result) const {
  attempt(result, "Allan deviation", [&] { result.allan = wanted_curve(octaves, options_.allan.type, rate_hz); });
  if (options_.data == SampleKind::phase && found_.missing > 0)
    result.allan.notes.push_back(
        plural(found_.missing, "missing reading") +
        " of the phase: filled with draws of what those around allow, but for the longest gaps");
  for (const DeviationType type : options_.more_types) {
    result.more_allan.push_back({});
    result.more_allan.back().type = type;
    attempt(result, name_of(type), [&] { result.more_allan.back() = wanted_curve(octaves, type, rate_hz); });
  }
}

NoiseFit Finish::fit_of_kept(const AllanCurve& octaves, double rate_hz, FitOptions options) const {
  // What is fitted of a clock is not what is in the log.
  if (options.clock) options.difference_kurtosis = std::nullopt;
  const bool opinion = !octaves.points.empty();
  const bool cleaned = !despiked_.samples.empty();
  AllanCurve own;
  RecordKnowledge known;
  known.temperature = read_.temperature.get();
  if (!cleaned) {
    known.series = series_ ? &*series_ : nullptr;
    if (options_.data == SampleKind::rate) known.missing = found_.missing;
  }
  if (cleaned && opinion) own = pyramid_deviation(despiked_.samples, 1 / rate_hz);
  NoiseFit fit = fit_record(cleaned ? despiked_.samples : kept_, rate_hz, opinion ? cleaned ? &own : &octaves : nullptr,
                            options, &workspace_.fit, known);
  add_spike_answer(despiked_.answer, fit);
  return fit;
}

NoiseFit Finish::fit_of_sums(const AllanCurve& octaves, double rate_hz, FitOptions options) {
  return fit_sums(std::move(read_.sums.record), rate_hz, octaves.points.empty() ? nullptr : &octaves, options,
                  &workspace_.fit);
}

// To be fitted, and no clock or counter: the result says which.
bool Finish::is_noise(ChannelResult& result) const {
  if (options_.data == SampleKind::phase) return true;  // the phase of a clock does rise
  if (found_.signs.counter.empty()) return true;
  result.findings.push_back(finding("no_fit", "no noise fit: the channel " + found_.signs.counter));
  return false;
}

// Filled gaps are stiller than any sensor.
std::optional<EventSeries> Finish::series(double rate_hz) const {
  const std::uint64_t samples = found_.samples + found_.missing;
  if (samples < kFewestForMotion || found_.missing * 100 > samples) return std::nullopt;
  return is_whole() ? event_series(kept_, rate_hz) : read_.sums.record.plain.means.series(rate_hz);
}

void Finish::find_motion(ChannelResult& result, double rate_hz) {
  if (options_.data != SampleKind::rate || !options_.fit.remedies) return;
  series_ = series(rate_hz);
  if (!series_) return;
  result.means = coarse(*series_);
  const auto unit = find_unit(result.channel.unit);
  // The air around a thermometer moves, and not the thermometer.
  if (unit && unit->quantity == Quantity::temperature) return;
  result.motion = libchar::find_motion(*series_);
  add_findings(result.motion.findings, result);
}

// A sensor that moves shows its motion and not its noise: no coefficients of a recording that moves
// throughout, and a sentence where a stretch of it does.
bool Finish::is_at_rest(ChannelResult& result, double rate_hz) {
  find_motion(result, rate_hz);
  if (!result.motion.whole || !options_.wanted.fit) return true;
  result.findings.push_back(finding("no_fit", "no noise fit: the recording holds a signal throughout"));
  return false;
}

// Of samples as the log has them: those of other kinds are differences or ratios. A counter's frequencies are rounded
// as samples are; a phase's rounding is in its white phase noise.
void Finish::find_digital(ChannelResult& result, double rate_hz) const {
  if (found_.samples == 0 || !options_.wanted.fit) return;
  const ValueCensus census = census_of(found_);
  if (options_.data == SampleKind::phase) {
    const auto coarse = detail::find_coarse_counter(census, found_.samples, found_.resolution, result.trace_unit);
    if (coarse) result.findings.push_back(*coarse);
    return;
  }
  const DigitalSums of_kept = is_whole() ? digital_sums(kept_, census, found_.missing) : DigitalSums{};
  DigitalFaults faults =
      find_digital_faults(is_whole() ? of_kept : read_.sums.digital, census, rate_hz,
                          has(found_.findings, "dead_band") ? std::nullopt : found_.resolution, result.channel.unit);
  if (options_.data == SampleKind::rate) {
    result.digital = std::move(faults);
    return add_findings(result.digital.findings, result);
  }
  if (!faults.rounding) return;
  const double nominal = options_.nominal_frequency == 0 ? 1 : options_.nominal_frequency;
  result.digital.rounding = DigitalFaults::Rounding{faults.rounding->step / std::abs(nominal),
                                                    faults.rounding->variance / (nominal * nominal),
                                                    faults.rounding->sd / (nominal * nominal)};
}

void Finish::fit(const AllanCurve& octaves, double rate_hz, ChannelResult& result) {
  if (!is_noise(result)) return;
  find_digital(result, rate_hz);
  attempt(
      result, "noise fit",
      [&] {
        if (!is_at_rest(result, rate_hz)) return;
        FitOptions options = options_.fit;
        const std::string& unit = result.channel.unit;
        if (unit != "1") options.unit = unit;  // for sentences: a ratio has none
        options.clock = options_.data != SampleKind::rate;
        if (!options.clock) options.at_rest = detail::limit_at_rest(unit);
        if (worst_of(result.motion.findings) == Severity::bad)  // no coefficient of it will be used
          options.explain = options.events = options.stationarity = false;
        // Else of what is left; what is held repeats, and jumps.
        if (options_.unwrap == 0 && options_.frozen <= 1 && options_.interpolated == 0 &&
            !(found_.signs.held_times > 1))
          options.difference_kurtosis = found_.difference_kurtosis;
        const bool of_kept = is_whole() || read_.temperature;
        result.fit = of_kept ? fit_of_kept(octaves, rate_hz, options) : fit_of_sums(octaves, rate_hz, options);
        result.fit->moving_s = result.motion.moving_s;
        if (result.digital.rounding) detail::take_out_rounding(*result.digital.rounding, *result.fit);
        doubt_digital(result.digital, *result.fit);
        if (options_.data == SampleKind::phase)
          detail::doubt_bridged(
              static_cast<double>(found_.missing) / static_cast<double>(found_.samples + found_.missing), *result.fit);
      },
      "no_fit");
}

// Curve and fit side by side: both need the record and the octaves.
void Finish::curve_and_fit(ChannelResult& curve, ChannelResult& result, double rate_hz) {
  AllanCurve octaves;
  bool there = false;
  attempt(curve, "Allan deviation", [&] {
    octaves = this->octaves(rate_hz);
    there = true;
  });
  parallel::both(
      [&] {
        if (there) add_curves(octaves, rate_hz, curve);
      },
      [&] { fit(octaves, rate_hz, result); });
}

void Finish::add_spectrum(ChannelResult& result, double rate_hz) {
  const auto make = [&] {
    if (options_.average == SegmentAverage::median) return median_welch(kept_, rate_hz, options_.spectrum);
    if (is_whole()) return welch(kept_, rate_hz, options_.spectrum, &workspace_.welch);
    if (spectrum_of_all(options_))
      return welch_using_up(std::move(kept_), rate_hz, options_.spectrum, &workspace_.welch);
    if (read_.spectrum) return read_.spectrum->finish(rate_hz);
    const WelchOptions options = streamed_spectrum(options_.spectrum);
    return WelchStream(options, read_.sums.spectrum).finish(rate_hz);
  };
  attempt(result, "spectrum", [&] {
    Spectrum spectrum = make();
    const std::size_t bins = detail::in_memory(options_.spectrum_bins);
    parallel::both(
        [&] {
          if (options_.wanted.lines) result.lines = find_lines(spectrum, 1e-3, quantization());
        },
        [&] {
          if (bins > 0) result.spectrum = log_binned(spectrum, bins);
        });
    if (bins == 0) result.spectrum = std::move(spectrum);
    if (options_.spectrum.segment == 0 && !is_whole() && !options_.quarter_segments)
      result.spectrum.notes.push_back(streamed_segment_note());
  });
}

// A thread that has no channel of its own left takes a part of another's. Isolated: one that waits for it begins no
// other channel, whose memory would come on top. A spectrum that uses the samples up comes last.
void Finish::finish(ChannelResult& result, double rate_hz) {
  ChannelResult curve, spectrum;
  const std::size_t before = result.findings.size();
  const bool last = !is_whole() && spectrum_of_all(options_);
  parallel::isolated([&] {
    parallel::both(
        [&] {
          if (wants_fit())
            curve_and_fit(curve, result, rate_hz);
          else if (options_.wanted.spectrum && found_.signs.counter.empty())
            find_motion(result, rate_hz);
        },
        [&] {
          if (options_.wanted.spectrum && !last) add_spectrum(spectrum, rate_hz);
        });
    if (options_.wanted.spectrum && last) add_spectrum(spectrum, rate_hz);
  });
  result.allan = std::move(curve.allan);
  result.more_allan = std::move(curve.more_allan);
  result.spectrum = std::move(spectrum.spectrum);
  result.lines = std::move(spectrum.lines);
  add_findings(spectrum.findings, curve);
  result.findings.insert(result.findings.begin() + static_cast<std::ptrdiff_t>(before), curve.findings.begin(),
                         curve.findings.end());
}

// The unit of an integral where a rate is analysed: a clock's time error, an angle, or what was turned through from one
// sample to the next, whose noise is as large in samples as in sums.
void Finish::doubt_unit(ChannelResult& result, double rate_hz) const {
  const std::string& unit = result.channel.unit;
  const auto known = find_unit(unit);
  if (options_.data != SampleKind::rate || !known || found_.samples < 2) return;
  if (!(found_.difference_sd > 1e-9 * found_.standard_deviation)) return;  // constant, or a counter
  const bool time = known->quantity == Quantity::time;
  if ((time || known->quantity == Quantity::frequency) &&
      found_.standard_deviation < kClockScatter * std::abs(found_.mean))
    return doubt_frequency(result);
  if (!time && (known->quantity != Quantity::angle || !detail::names_angular_rate(result.channel.name))) return;
  const bool increments = !time && found_.difference_sd > found_.standard_deviation;
  const char* const what = time ? "as the time error of a clock the samples are a phase, not a fractional frequency"
                           : increments ? "the samples are increments of an angle, not an angular rate"
                                        : "the samples are an angle, and no angular rate";
  Finding integral = finding("integral_unit", fmt::format("The unit is {}: {}.", unit, what));
  Finding::Help& help = integral.help.emplace_back(
      Finding::Help{increments ? "Take each as a rate over its sampling interval." : "Say so."});
  if (increments)
    help.options = {{"channel_scale", fmt::format("{}={}", result.channel.name, shortest(rounded(rate_hz, 9)))},
                    {"channel_unit", fmt::format("{}={}/s", result.channel.name, unit)}};
  else
    help.options = {{"data", "phase"}, {"channels", result.channel.name}};  // not of the others
  result.findings.push_back(std::move(integral));
}

// A clock is a few parts in a million off, not a hundredth: else somebody has named the wrong kind
// of data, or no nominal frequency.
void Finish::doubt_frequency(ChannelResult& result) const {
  constexpr double kMostOff = 0.01;
  if (found_.samples == 0) return;
  const double nominal = options_.nominal_frequency;
  if (found_.standard_deviation == 0) return;
  if (nominal == 0 && found_.standard_deviation < kClockScatter * std::abs(found_.mean)) {
    Finding whole =
        finding("frequency_mean", fmt::format("The values scatter by {} of their mean, {}: they look like frequencies "
                                              "or periods themselves, not like {}.",
                                              number_text(found_.standard_deviation / std::abs(found_.mean), 2),
                                              number_text(found_.mean, 6),
                                              options_.data == SampleKind::phase ? "a phase" : "fractions of them"));
    Finding::Help& help = whole.help.emplace_back(Finding::Help{"Take them as fractions of their mean."});
    if (options_.data != SampleKind::frequency) help.options.push_back({"data", "frequency"});
    help.options.push_back({"nominal_frequency", shortest(rounded(found_.mean, 9))});
    result.findings.push_back(std::move(whole));
    return;
  }
  if (options_.data != SampleKind::frequency) return;
  const double off = nominal == 0 ? found_.mean : found_.mean / nominal - 1;
  if (std::abs(off) <= kMostOff) return;
  result.findings.push_back(
      finding("frequency_mean", nominal == 0 ? fmt::format("The mean is {}: without `nominal_frequency` values are "
                                                           "taken for fractional frequencies, which are small.",
                                                           number_text(found_.mean, 6))
                                             : fmt::format("The mean, {}, is far from the nominal frequency of {}.",
                                                           number_text(found_.mean, 6), number_text(nominal, 6))));
}

// The integral of a rate's white noise is a random walk; the rate of a sensor has white noise on top, at the latest
// between the fastest samples.
// Where the fit cannot tell N from another term, the Allan variance at the sampling interval limits it, N² rate +
// K²/(2 rate): at 95 %, by the least K of its interval. A rate whose N is at the limit is doubted in 5 % of records.
std::optional<double> Finish::white_limit(const Coefficient& walk, double rate_hz) const {
  constexpr double kNormal = 1.645, kDescribed = 0.5;
  if (options_.data != SampleKind::rate || found_.samples == 0) return std::nullopt;
  const double of_walk = 0.5 * walk.ci95.low * walk.ci95.low / rate_hz;
  const double measured = 0.5 * found_.difference_sd * found_.difference_sd;
  if (!(measured > kDescribed * of_walk)) return std::nullopt;  // the walk is not that of the fastest samples
  const double most = measured * (1 + kNormal * std::sqrt(3 / static_cast<double>(found_.samples)));
  return std::sqrt(std::max(0.0, most - of_walk) / rate_hz);
}

void Finish::doubt_rate(ChannelResult& result, double rate_hz) const {
  constexpr double kShare = 1;  // of the walk's own root density there
  if (options_.data == SampleKind::phase || !result.fit || has(result.findings, "integral_unit")) return;
  const Coefficient& walk = (*result.fit)[Term::walk];
  const Coefficient& white = (*result.fit)[Term::white];
  if (walk.status != Status::detected || !walk.value) return;
  const auto limit = white.status == Status::undetermined ? white_limit(walk, rate_hz) : white.upper95;
  if (!limit || *limit > kShare * *walk.value / (std::numbers::pi * rate_hz)) return;
  Finding integral = finding("looks_integrated",
                             "The record is a random walk up to its fastest samples, without white noise: this is "
                             "typical of an angle, a velocity or a phase, not of a rate.");
  integral.help.push_back({"Where it is one, say so.", {{"data", "phase"}}});
  result.findings.push_back(std::move(integral));
}

// Where it moves for a part of the record, the rest of it may be used.
void Finish::doubt_rest(ChannelResult& result, double rate_hz) const {
  if (options_.data != SampleKind::rate || !result.fit || has(result.findings, "motion")) return;
  const double step = found_.resolution.value_or(0);
  if (auto moves = detail::doubt_rest(*result.fit, result.channel.unit, step * step / (12 * rate_hz)))
    result.findings.push_back(*std::move(moves));
}

// Differenced phase and fractional frequency have other units than the samples in the log.
std::string Finish::unit_of_rate(const std::string& unit) const {
  if (options_.data == SampleKind::phase) return detail::differenced_unit(unit).unit;
  return options_.data == SampleKind::frequency && options_.nominal_frequency != 0 ? "1" : unit;
}

// The quality in the unit of the rate: what a model is made of. A phase's resolution and range are those of no rate.
ChannelQuality Finish::quality_of_rate() const {
  ChannelQuality quality = found_;
  if (options_.data == SampleKind::phase) {
    quality.resolution = std::nullopt;
    quality.saturated = 0;
  }
  const double nominal = options_.nominal_frequency;
  if (options_.data != SampleKind::frequency || nominal == 0) return quality;
  for (double* value : {&quality.mean, &quality.minimum, &quality.maximum}) *value = (*value - nominal) / nominal;
  for (double* value : {&quality.standard_deviation, &quality.difference_sd, &quality.float32_step})
    *value /= std::abs(nominal);
  if (quality.resolution) *quality.resolution /= std::abs(nominal);
  return quality;
}

ChannelResult Finish::result(const Channel& channel, const TimeBase& time) {
  const double rate_hz = time.rate_hz;
  ChannelResult result;
  result.channel = channel;
  result.channel.unit = unit_of_rate(channel.unit);
  if (options_.data == SampleKind::phase) phase_factor_ = detail::differenced_unit(channel.unit).factor;
  found_ = read_.sums.meters.quality.finish(rate_hz);
  std::erase_if(found_.findings, [this](const Finding& one) { return is_answered(one); });
  for (Finding& one : found_.findings)
    for (Finding::Help& help : one.help)
      std::erase_if(help.options, [this](const Finding::Setting& setting) {
        return setting.option == "data" && options_.data != SampleKind::rate;
      });
  result.quality = quality_of_rate();
  result.trace_unit = channel.unit;
  if (options_.wanted.quality) result.trace = read_.sums.meters.trace.finish();
  if (rate_hz <= 0) {
    const std::string why = found_.samples < 2
                                ? fmt::format("{}, and so no rate", plural(found_.samples, "sample"))
                                : fmt::format("the sampling rate is not known ({})", detail::rate_remedy(time));
    result.findings.push_back(finding("no_fit", "no curves and no fit: " + why));
    return result;
  }
  doubt_unit(result, rate_hz);
  if (options_.data != SampleKind::rate) doubt_frequency(result);
  is_whole_ = found_.samples + found_.missing <= kLeafSamples;
  kept_ = std::move(is_whole_ ? read_.sums.kept : read_.all);
  make_rate(rate_hz);
  finish(result, rate_hz);
  doubt_rate(result, rate_hz);
  doubt_rest(result, rate_hz);
  result.noise_types = noise_types_;
  if (result.fit && !noise_types_.empty())
    result.fit->findings.push_back(finding(
        "noise_types",
        "Noise types by the lag-1 autocorrelation, as Stable32 names them: " + noise_types_text(noise_types_) + "."));
  const auto add_to = [&](AllanCurve& curve) {
    result.fit ? add_fit_intervals(curve, *result.fit) : add_intervals(curve, white_alone(result.allan));
  };
  add_to(result.allan);
  for (AllanCurve& curve : result.more_allan) add_to(curve);
  return result;
}

}  // namespace

std::string what_needs_all_samples(const CharacterizeOptions& options) {
  if (!options.temperature.empty()) return "a correction for temperature";
  if (options.wanted.spectrum && spectrum_of_all(options))
    return options.quarter_segments                    ? "a spectrum of segments of a quarter of the record"
           : options.average == SegmentAverage::median ? "a median of segments"
                                                       : "a spectrum of a phase with these segments";
  if (!options.wanted.allan) return "";
  std::vector<DeviationType> types = options.more_types;
  types.insert(types.begin(), options.allan.type);
  for (const DeviationType type : types)
    if (type != DeviationType::oadev) return fmt::format("the deviation {}", name_of(type));
  if (options.allan.grid != TauGrid::octave) return "a curve at other times than octaves";
  return options.full_overlap ? "a curve with full overlap" : "";
}

ChannelResult finish_channel(ReadChannel read, const CharacterizeOptions& options, CharacterizeWorkspace& workspace,
                             const Channel& channel, const TimeBase& time) {
  return Finish(read, options, workspace).result(channel, time);
}

}  // namespace libchar

// A record becomes bins and a fit: as one exact transform where it fits into a leaf, by the sums
// over its leaves where it does not. Which of both depends on its length only, so that whoever has
// the samples, and however many at a time, finds the same bits.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/numeric/present.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fit/curve/shaped_curves.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/detail/band/bridge.hpp"
#include "libchar/fit/detail/curve/coefficients.hpp"
#include "libchar/fit/detail/record/dct_means.hpp"
#include "libchar/fit/detail/record/ends.hpp"
#include "libchar/fit/detail/record/record_means.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "libchar/fit/remedies.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {
namespace {

// The interval of white noise whose samples are not Gaussian. Whittle's likelihood takes periodogram ordinates for
// independent. Of white noise of excess kurtosis g they share 2 + g instead of 2: with theta = N^2 and n samples
//   var(ln theta) = var of the likelihood + g / n
// (D. R. Brillinger, "Time Series: Data Analysis and Theory", 1981, theorem 5.10.1: covariance of
// spectral averages = Gaussian part + fourth cumulant / n). Differences of white noise have half
// its excess kurtosis. Slower terms have weights that do not see white noise, so that theirs stays.

/// Outliers that cannot be taken out of N: a share p of them, of s standard deviations, makes the excess kurtosis of
/// the differences p s^4 / 2 and N too large by p s^2 / 2. Larger ones that make the same kurtosis move N less,
/// smaller ones cannot be distinguished from noise: the interval of N reaches down to where it is without them, as
/// far as those below the alarm go.
void reach_below_outliers(double difference_kurtosis, std::uint64_t samples, Coefficient& white) {
  constexpr double kSmallest = 3.5, kDeviates = 2;  ///< standard deviations of an outlier; of the kurtosis
  const double excess = std::min(difference_kurtosis, spike_alarm(samples)) - 3;
  if (!white.value || !(excess > kDeviates * detail::kurtosis_sd(samples))) return;
  white.ci95.low *= std::max(0.0, 1 - excess / (kSmallest * kSmallest));
}

// Widens the interval and covariance of the white noise by what heavy tails add, and says so;
// nothing where the kurtosis of first differences is below `spike_alarm(samples)`, as of Gaussian
// noise. `samples` without the missing ones.
void widen_for_tails(double difference_kurtosis, std::uint64_t samples, NoiseFit& fit) {
  constexpr auto kWhite = static_cast<std::size_t>(Term::white);
  Coefficient& white = fit.term[kWhite];
  reach_below_outliers(difference_kurtosis, samples, white);
  if (!(difference_kurtosis > spike_alarm(samples))) return;
  double& variance = fit.covariance[kWhite][kWhite];
  if (!white.value || !(variance > 0)) return;
  const double more = 2 * (difference_kurtosis - 3) / static_cast<double>(samples);
  variance += more;
  const double before = std::log(white.ci95.high / *white.value);
  widen_by(std::sqrt(more) / 2, white);
  const double wider = std::log(white.ci95.high / *white.value) / before;
  if (wider > 1.05)
    fit.findings.push_back(finding(
        "heavy_tails", fmt::format("The samples have heavier tails than Gaussian noise (kurtosis of differences {} "
                                   "instead of 3): the interval of N is {} times as wide for it.",
                                   brief_text(difference_kurtosis), brief_text(wider, 2))));
}

/// The white noise that most of the differences of samples are: of a clock whose phase is read, that of the readings.
struct DifferencesOf {
  Term term = Term::white;
  double density = 0;  ///< the coefficient's square of a variance of one, as half of the differences have it
};
DifferencesOf differences_of(const NoiseFit& fit, double rate_hz, bool clock) {
  const std::optional<double> white = fit[Term::white].value, phase = fit[Term::quantization].value;
  const double density_of_phase = 1 / (3 * rate_hz * rate_hz);  // var(x'') = 6 var(x)
  if (clock && phase && *phase * *phase / density_of_phase > white.value_or(0) * white.value_or(0) * rate_hz)
    return {Term::quantization, density_of_phase};
  return {Term::white, 1 / rate_hz};
}

/// Outliers that are too small to be left out one by one are white noise to a spectrum: their
/// variance is taken out of N², or of Q² of a clock's phase.
void take_out_outliers(const std::optional<OutlierVariance>& outliers, double rate_hz, bool clock, NoiseFit& fit) {
  const DifferencesOf of = differences_of(fit, rate_hz, clock);
  const auto index = static_cast<std::size_t>(of.term);
  Coefficient& term = fit.term[index];
  if (!outliers || !term.value) return;
  const double square = *term.value * *term.value, theirs = outliers->variance * of.density;
  if (!(theirs < square)) return;
  const double core = std::sqrt(square - theirs), share = core / *term.value;
  const double more = outliers->sd * of.density / (2 * core * core);
  widen_by(more, term);
  term.ci95 = {share * term.ci95.low, share * term.ci95.high};
  fit.covariance[index][index] += 4 * more * more;
  fit.theta[index] *= share * share;
  constexpr double kNoticeable = 0.1;  // of the standard deviation of N
  const bool noticeable = outliers->seen && 1 / share - 1 > kNoticeable * term.relative_sd;
  const std::string_view what = of.term == Term::white ? "N" : "the white phase noise";
  if (noticeable)
    fit.findings.push_back(finding("outliers_in_n",
                                   fmt::format("Outliers too small to be left out one by one add {} to {}: it is that "
                                               "of the Gaussian core of the samples.",
                                               percent_text(1 / share - 1), what),
                                   fmt::format("small outliers were taken out of {}", what)));
  term.value = core;
}

constexpr std::uint64_t kMeansOfPoint = 8;  ///< from which on terms of a pyramid start often enough
constexpr double kMostOfEvents = 0.2;       ///< share of a point's variance

/// Allan variance of events: of a step from all starts, of drifts from their middle slope.
double event_variance(std::span<const Event> events, double rate_hz, double samples, double m) {
  double sum = 0;
  const double terms = std::max(1.0, samples - 2 * m + 1), tau_s = m / rate_hz;
  for (const Event& event : events) {
    if (event.kind == EventKind::step) sum += event.size * event.size * (2 * m * m + 1) / (6 * m * terms);
    if (event.kind == EventKind::cycle) {
      const double angle = std::numbers::pi * tau_s / event.period_s;
      sum += std::pow(event.size * std::sin(angle) * std::sin(angle) / angle, 2);
    }
    if (event.kind == EventKind::ramp) sum += 0.5 * std::pow(event.slope * tau_s, 2);
    if (event.kind == EventKind::warm_up) {
      const double fall = -std::expm1(-tau_s / event.tau_s);
      sum += 0.25 * std::pow(event.size * event.tau_s / tau_s * fall * fall, 2) * event.tau_s * rate_hz / samples;
    }
  }
  return sum;
}

/// The octaves of a record without its events: the long ones from its means, of the short ones what is hardly theirs.
AllanCurve curve_without(const FittedSums& sums, std::span<const Event> events, double rate_hz) {
  AllanCurve curve = octave_curve(sums.allan, 1 / rate_hz);
  const std::uint64_t per_mean = sums.means.per_mean(), from = kMeansOfPoint * per_mean;
  std::erase_if(curve.points, [&](AllanPoint& point) {
    const double variance = point.deviation * point.deviation;
    const double of_events =
        event_variance(events, rate_hz, static_cast<double>(curve.samples), static_cast<double>(point.m));
    if (point.m >= from || of_events > kMostOfEvents * variance) return true;
    point.deviation = std::sqrt(variance - of_events);
    return false;
  });
  std::vector<double> means = sums.means.means();
  const auto length = static_cast<double>(per_mean);
  for (std::size_t i = 0; i < means.size(); ++i)
    means[i] -= event_mean(events, rate_hz, static_cast<double>(i) * length, length);
  for (AllanPoint point : pyramid_deviation(means, length / rate_hz).points) {
    point.m *= per_mean;
    if (point.m >= from) curve.points.push_back(point);
  }
  return curve;
}

/// What is done about spikes, by all leaves together.
SpikeAnswer spikes_of(const RecordSums& sums, std::uint64_t samples, const FitOptions& options) {
  if (!options.remedies || !sums.cleaned || !options.difference_kurtosis) return {};
  const double alarm = spike_alarm(samples);
  if (!(*options.difference_kurtosis > alarm)) return {};
  return spike_answer(*options.difference_kurtosis, alarm, sums.spikes);
}

RecordMeans means_of(const FittedSums& sums, double rate_hz, const FitOptions& options) {
  if (!options.events || !options.remedies) return {};
  try {
    return means_in(sums.means.series(rate_hz), options);
  } catch (const Error& error) {  // hardly a mean is present
    if (error.problem().kind != ErrorKind::numeric) throw;
    return {};
  }
}

bool has_step(std::span<const Event> events) {
  return std::any_of(events.begin(), events.end(), [](const Event& event) { return event.kind == EventKind::step; });
}

/// What stretches differ by where most is known of a term: at its largest share² of the Allan variance over tau.
StretchSpread spread_of(Term term, const NoiseFit& fit) {
  const auto known = [&](const StretchSpread& at) {
    const double m = at.tau_s * fit.rate_hz, dt_s = 1 / fit.rate_hz;
    const double all = allan_variance(fit.theta, m, dt_s) + process_allan_variance(fit, m, dt_s);
    const double share = fit.theta[static_cast<std::size_t>(term)] * unit_allan_variance(term, m, dt_s) / all;
    return share * share / at.tau_s;
  };
  return *std::max_element(fit.stationarity.spread.begin(), fit.stationarity.spread.end(),
                           [&](const auto& a, const auto& b) { return known(a) < known(b); });
}

/// A coefficient is the mean of what the stretches have, as the points of the Allan curve are.
void widen_by_stretches(NoiseFit& fit) {
  for (std::size_t t = 0; t < kTerms; ++t) {
    Coefficient& term = fit.term[t];
    if (!term.value || !(fit.theta[t] > 0)) continue;
    const StretchSpread spread = spread_of(static_cast<Term>(t), fit);
    widen_by(spread.relative_sd / std::sqrt(spread.independent), term);
  }
}

void report_stationarity(NoiseFit& fit) {
  const Stationarity& found = fit.stationarity;
  if (found.steady) return;
  widen_by_stretches(fit);
  Finding changed = finding("not_stationary", found.sentence, "the noise is not the same throughout the recording");
  if (!found.noticeable) changed.severity = Severity::note;
  changed.where.time_s = {found.smallest_s, found.largest_s};
  fit.findings.push_back(std::move(changed));
}

constexpr double kMostOfEnds = 0.01;  ///< share of the slowest coefficient

/// What the terms make of a record, whether they describe it or not.
detail::EndNoise end_noise(std::span<const PooledPower> powers, double rate_hz, const FitOptions& options) {
  std::vector<PowerBin> bins = power_bins(powers, rate_hz);
  if (options.clock) lend_flicker_phase(rate_hz, bins);
  const TermSet terms = {true, true, true, true, options.clock};
  return {score(bin_problem(bins), terms).at.theta, 1 / rate_hz};
}

std::span<const double> longest_run(std::span<const double> record) {
  std::span<const double> longest;
  while (!record.empty()) {
    const std::span<const double> run = record.first(present_run(record));
    if (run.size() > longest.size()) longest = run;
    record = record.subspan(std::max<std::size_t>(run.size(), 1));
  }
  return longest;
}

/// Where phase noise is so strong that its ends are in the slow coefficients, these are without them.
std::vector<PooledPower> powers_without_ends(std::span<const double> record, double rate_hz,
                                             const FitOptions& options) {
  constexpr std::size_t kFewest = 64;
  std::vector<PooledPower> powers = whole_powers(record);
  const std::span<const double> run = longest_run(record);
  if (run.size() < kFewest) return powers;
  detail::EndNoise noise = end_noise(powers, rate_hz, options);
  if (!(detail::share_of_ends(noise, run.size()) > kMostOfEnds)) return powers;
  Dct dct(run.size());
  noise = detail::noise_with_ends(dct.transform(run), noise, options.clock);
  return whole_powers(record, &noise);
}

std::vector<PooledPower> powers_without_ends(PowerSums sums, std::span<const Event> events, double rate_hz,
                                             const FitOptions& options) {
  std::vector<PooledPower> powers = powers_of(std::move(sums), events, rate_hz);
  const detail::EndNoise noise = end_noise(powers, rate_hz, options);
  for (PooledPower& power : powers) detail::leave_out_ends(noise, power);
  std::erase_if(powers, [](const PooledPower& power) { return power.mean.empty(); });
  return powers;
}

NoiseFit fit_whole(std::span<const double> record, double rate_hz, const AllanCurve* allan, const FitOptions& options,
                   FitWorkspace* workspace, const RecordKnowledge& known) {
  const DespikedRecord despiked =
      options.remedies ? without_spikes(record, options.difference_kurtosis) : DespikedRecord{};
  std::span<const double> data = despiked.samples.empty() ? record : std::span<const double>(despiked.samples);
  const EventSeries* series = despiked.samples.empty() ? known.series : nullptr;
  const RecordMeans means = without_means(data, rate_hz, options, known.temperature, series);
  if (!means.samples.empty()) data = means.samples;
  AllanCurve own;  // a curve of the spikes and steps is no opinion on what is left
  if (allan != nullptr && data.data() != record.data()) {
    own = pyramid_deviation(data, 1 / rate_hz);
    allan = &own;
  }
  std::vector<double> filled;
  const bool as_recorded = data.data() == record.data();
  const std::uint64_t missing = known.missing ? *known.missing : count_missing(record);
  const std::uint64_t samples = record.size() - missing;
  const bool complete = despiked.samples.empty() ? missing == 0 : present_run(data) == data.size();
  if (options.remedies && !complete) filled = bridged(data);
  const std::span<const double> present = filled.empty() ? data : std::span<const double>(filled);
  const std::vector<PooledPower> powers =
      present.size() > kLeafSamples ? powers_without_ends(record_sums(present, false).plain.bins, {}, rate_hz, options)
                                    : powers_without_ends(present, rate_hz, options);
  NoiseFit fit = fit_powers(powers, rate_hz, samples, allan, options, workspace, spent_on(means));
  if (!options.clock) {
    const bool counted = options.difference_kurtosis && as_recorded;
    widen_for_tails(counted ? *options.difference_kurtosis : kurtosis_of_differences(data), samples, fit);
  }
  take_out_outliers(despiked.answer.outliers, rate_hz, options.clock, fit);
  report_means(means, options, fit);
  add_spike_answer(despiked.answer, fit);
  if (options.remedies && options.stationarity) {
    fit.stationarity = test_stationarity(data, rate_hz, fit);
    report_stationarity(fit);
  }
  return fit;
}

}  // namespace

NoiseFit fit_sums(RecordSums sums, double rate_hz, const AllanCurve* allan, const FitOptions& options,
                  FitWorkspace* workspace) {
  const std::uint64_t samples = sums.plain.allan.samples - sums.plain.allan.missing;
  const SpikeAnswer answer = spikes_of(sums, samples, options);
  const bool cleaned = answer.remedy.has_value();
  FittedSums& used = cleaned ? *sums.cleaned : sums.plain;
  const RecordMeans means = means_of(used, rate_hz, options);
  const std::span<const Event> events =
      means.events_taken ? std::span<const Event>(means.search.events) : std::span<const Event>();
  AllanCurve own;  // a curve of the spikes and steps is no opinion on what is left
  if (allan != nullptr && (cleaned || !events.empty())) {
    own = events.empty() ? octave_curve(used.allan, 1 / rate_hz) : curve_without(used, events, rate_hz);
    allan = &own;
  }
  const std::vector<PooledPower> powers = powers_without_ends(std::move(used.bins), events, rate_hz, options);
  NoiseFit fit = fit_powers(powers, rate_hz, samples, allan, options, workspace, spent_on(means));
  // Spikes and steps are in the kurtosis of the differences; what it would be without them is not known.
  if (!options.clock && options.difference_kurtosis && !cleaned && !has_step(events))
    widen_for_tails(*options.difference_kurtosis, samples, fit);
  take_out_outliers(answer.outliers, rate_hz, options.clock, fit);
  report_means(means, options, fit);
  add_spike_answer(answer, fit);
  if (options.remedies && options.stationarity) {
    fit.stationarity = test_stationarity(used, events, rate_hz, fit);
    report_stationarity(fit);
  }
  return fit;
}

NoiseFit fit_record(std::span<const double> record, double rate_hz, const AllanCurve* allan, const FitOptions& options,
                    FitWorkspace* workspace, const RecordKnowledge& known) {
  if (record.size() <= kLeafSamples || known.temperature != nullptr)
    return fit_whole(record, rate_hz, allan, options, workspace, known);
  FitOptions chosen = options;
  if (!chosen.difference_kurtosis) chosen.difference_kurtosis = kurtosis_of_differences(record);
  return fit_sums(record_sums(record, options.remedies), rate_hz, allan, chosen, workspace);
}

}  // namespace libchar

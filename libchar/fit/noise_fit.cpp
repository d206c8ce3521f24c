#include "libchar/fit/noise_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/core/coefficient.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/interval.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/present.hpp"
#include "libchar/fit/detail/allan_fit.hpp"
#include "libchar/fit/detail/bridge.hpp"
#include "libchar/fit/detail/coefficients.hpp"
#include "libchar/fit/detail/contradiction.hpp"
#include "libchar/fit/detail/goodness.hpp"
#include "libchar/fit/detail/low_pass.hpp"
#include "libchar/fit/power_bins.hpp"
#include "libchar/fit/remedies.hpp"

namespace libchar {

namespace {

constexpr double kAlarmP = 1e-4;  ///< probability of a false alarm of the residuals' ends
constexpr double kRemedyRatio =
    15;  ///< 2 ln L a remedy with one parameter must gain to be taken (1e-4)
constexpr double kRampRatio = 5.41;  ///< the same for a ramp: passed by 0.5 % of clean records
constexpr std::size_t kLowest = 5;   ///< coefficients that a warm-up or a drift falls into

constexpr auto kQuantization = static_cast<std::size_t>(Term::quantization);
constexpr auto kRamp = static_cast<std::size_t>(Term::ramp);

/// The bins of the moment, what is offered, and the fit; remedies change all three.
struct Attempt {
  std::vector<PowerBin> bins;
  FitOptions options;
  NoiseFit fit;
  double half_deviance = 0;
};

void require_enough(std::size_t bins, const TermSet& terms) {
  const std::size_t wanted = count_of(terms);
  if (wanted == 0) {
    throw Error({ErrorKind::usage,
                 "",
                 "",
                 "no noise term was asked for",
                 "",
                 "offer at least white noise"});
  }
  if (bins >= wanted) return;
  throw Error(
      {ErrorKind::numeric,
       "",
       "",
       fmt::format(
           "{} bins of the spectrum are fewer than the {} noise terms to fit", bins, wanted),
       "",
       "use a longer record"});
}

Attempt attempt(std::vector<PowerBin> bins,
                double rate_hz,
                std::uint64_t samples,
                const FitOptions& options) {
  require_enough(bins.size(), options.terms);
  const BinProblem problem = bin_problem(bins);
  const Decision decision = decide(problem, options.terms, options.threshold);
  NoiseFit fit;
  fit.rate_hz = rate_hz;
  fit.samples = samples;
  fit.duration_s = static_cast<double>(samples) / rate_hz;
  fit.method = fmt::format("DCT-II Whittle likelihood, {} bins", bins.size());
  report_coefficients(problem, decision, options, fit);
  report_bounds(decision.kept, fit);
  fit.residuals = residuals_of(bins, fit.theta, rate_hz);
  fit.goodness = goodness_of(fit.residuals, count_of(only_positive(fit.theta)));
  const double deviance = half_deviance(problem, fit.theta);
  return {std::move(bins), options, std::move(fit), deviance};
}

/// Goodness of the residuals between two frequencies.
Goodness goodness_between(const NoiseFit& fit, double low_hz, double high_hz) {
  std::vector<FitResidual> part;
  for (const FitResidual& residual : fit.residuals) {
    if (residual.frequency_hz >= low_hz && residual.frequency_hz <= high_hz)
      part.push_back(residual);
  }
  return goodness_of(part, 0);
}

/// Median of measured/model over bins from..to-1, +infinity when there are fewer than three.
double median_ratio(const std::vector<FitResidual>& residual, std::size_t from, std::size_t to) {
  if (to < from + 3) return std::numeric_limits<double>::infinity();
  std::vector<double> ratio;
  for (std::size_t i = from; i < to; ++i) ratio.push_back(residual[i].measured / residual[i].model);
  const auto middle = ratio.begin() + static_cast<std::ptrdiff_t>(ratio.size() / 2);
  std::nth_element(ratio.begin(), middle, ratio.end());
  return *middle;
}

/// Bins of a broad peak (vibration, a wandering line): on the scale of the model a quarter and six
/// standard deviations above the median of the ten bins before as well as of the ten after, so that
/// a slope or a rising end is none.
std::vector<PowerBin> without_broad_peaks(const Attempt& now) {
  constexpr std::size_t kReach = 10;
  const std::vector<FitResidual>& residual = now.fit.residuals;
  std::vector<PowerBin> kept;
  for (std::size_t j = 0; j < now.bins.size(); ++j) {
    const double before = median_ratio(residual, j < kReach ? 0 : j - kReach, j);
    const double after = median_ratio(residual, j + 1, std::min(j + 1 + kReach, residual.size()));
    const double excess = residual[j].measured / residual[j].model / std::max(before, after) - 1;
    const double limit = std::max(0.25, 6 * std::sqrt(2 / now.bins[j].dof));
    if (now.bins[j].dof <= 32 || excess <= limit) kept.push_back(now.bins[j]);
  }
  return kept;
}

/// Humps are left out before anything else is read from the residuals.
void answer_broad_peaks(Attempt& now) {
  if (!(now.fit.goodness.p < kAlarmP)) return;
  std::vector<PowerBin> kept = without_broad_peaks(now);
  const std::uint64_t count = now.bins.size() - kept.size();
  if (count == 0 || kept.size() < now.bins.size() / 2) return;
  now = attempt(std::move(kept), now.fit.rate_hz, now.fit.samples, now.options);
  now.fit.remedies.push_back(
      {"lines",
       fmt::format("{} bin{} a quarter and six standard deviations above {} neighbours",
                   count,
                   count == 1 ? "" : "s",
                   count == 1 ? "its" : "their"),
       fmt::format("{} bin{} of broad peaks left out", count, count == 1 ? "" : "s"),
       count});
}

/// High frequencies misfit: quantization or a low-pass, whichever explains more.
void answer_high_frequencies(Attempt& now) {
  const double rate_hz = now.fit.rate_hz;
  const Goodness top = goodness_between(now.fit, rate_hz / 16, rate_hz);
  if (!(top.p < kAlarmP)) return;
  const std::string alarm =
      fmt::format("chi-square of the bins above {:.3g} Hz {:.0f} for {:.0f} degrees of freedom",
                  rate_hz / 16,
                  top.chi2,
                  top.dof);

  FitOptions with = now.options;
  with.terms[kQuantization] = true;
  std::optional<Attempt> quantized;
  if (!now.options.terms[kQuantization])
    quantized = attempt(now.bins, rate_hz, now.fit.samples, with);
  const std::optional<LowPassFit> low_pass = fit_low_pass(now.bins, rate_hz, now.options.terms);
  const double gain_quantized = quantized ? 2 * (now.half_deviance - quantized->half_deviance) : 0;
  const double gain_low_pass = low_pass ? 2 * (now.half_deviance - low_pass->half_deviance) : 0;
  if (std::max(gain_quantized, gain_low_pass) < kRemedyRatio) return;

  if (gain_quantized >= gain_low_pass) {
    quantized->fit.remedies = now.fit.remedies;
    now = std::move(*quantized);
    now.fit.remedies.push_back(
        {"quantization",
         alarm,
         fmt::format("quantization noise added to the model; 2 ln L rises by {:.0f}",
                     gain_quantized),
         1});
    return;
  }
  const std::vector<Remedy> before = now.fit.remedies;
  now = attempt(
      low_passed(now.bins, low_pass->corner_hz, rate_hz), rate_hz, now.fit.samples, now.options);
  now.fit.remedies = before;
  now.fit.bandwidth_hz = low_pass->corner_hz;
  const double spread = std::exp(1.959963984540054 * low_pass->log_sd);
  now.fit.bandwidth_ci95 = Interval{low_pass->corner_hz / spread, low_pass->corner_hz * spread};
  widen_for_joint_parameter(low_pass->log_theta_sd, now.fit);
  now.fit.remedies.push_back(
      {"bandwidth",
       alarm,
       fmt::format(
           "first-order low-pass with corner {:.4g} Hz added to the model; 2 ln L rises by {:.0f}",
           low_pass->corner_hz,
           gain_low_pass),
       1});
}

std::vector<PowerBin> without_lowest(const std::vector<PowerBin>& bins, double duration_s) {
  const double from_hz = (static_cast<double>(kLowest) - 0.5) / (2 * duration_s);
  std::vector<PowerBin> kept;
  for (const PowerBin& bin : bins) {
    if (bin.low_hz > from_hz * (1 - 1e-9)) kept.push_back(bin);
  }
  return kept;
}

/// 2 ln L by which the bins of `other` reject the theta of `fit`: small when the two are
/// consistent.
double rejection(const Attempt& other, const NoiseFit& fit) {
  return 2 * (half_deviance(bin_problem(other.bins), fit.theta) - other.half_deviance);
}

/// What `rejection` stays below in clean records. Its expectation is the information that the
/// dropped bins carried, tr(1 - I_dropped I^-1), nearly all in one direction, so that it scatters
/// like that times a chi-square of one degree of freedom. Below 1 the fit has moved by less than
/// one standard deviation: not worth a remedy.
double rejection_limit(const Attempt& now, const Attempt& dropped) {
  const TermSet terms = only_positive(now.fit.theta);
  const TermMatrix all = fisher_information(bin_problem(now.bins), now.fit.theta, terms);
  const TermMatrix rest = fisher_information(bin_problem(dropped.bins), now.fit.theta, terms);
  const double lost =
      static_cast<double>(count_of(terms)) - (rest * inverse_of(all, terms)).trace();
  return std::clamp(16 * lost, 1.0, 16.0);
}

void keep_remedies(NoiseFit& next, const NoiseFit& before) {
  next.remedies = before.remedies;
  next.bandwidth_hz = before.bandwidth_hz;
  next.bandwidth_ci95 = before.bandwidth_ci95;
}

/// A drift falls into the first few coefficients: a ramp, or those coefficients left out.
void answer_low_frequencies(Attempt& now) {
  std::vector<PowerBin> rest = without_lowest(now.bins, now.fit.duration_s);
  if (rest.size() < 2 * count_of(now.options.terms) || rest.size() == now.bins.size()) return;
  const Attempt dropped = attempt(std::move(rest), now.fit.rate_hz, now.fit.samples, now.options);
  const double rejects = rejection(dropped, now.fit);
  const double limit = rejection_limit(now, dropped);
  const Goodness low = goodness_between(now.fit, 0, (kLowest + 0.5) / (2 * now.fit.duration_s));
  FitOptions with = now.options;
  with.terms[kRamp] = true;
  std::optional<Attempt> ramp;
  if (!now.options.terms[kRamp]) ramp = attempt(now.bins, now.fit.rate_hz, now.fit.samples, with);
  const double gain = ramp ? 2 * (now.half_deviance - ramp->half_deviance) : 0;
  if (rejects < limit && low.p > 1e-3 && gain < kRampRatio) return;

  const std::string alarm = fmt::format(
      "the slowest {} coefficients do not follow the rest (2 ln L {:.1f}; with a ramp {:.1f})",
      kLowest - 1,
      rejects,
      gain);
  const bool ramp_explains =
      ramp && gain > kRampRatio && rejection(dropped, ramp->fit) < limit &&
      goodness_between(ramp->fit, 0, (kLowest + 0.5) / (2 * now.fit.duration_s)).p > 0.005;
  if (ramp_explains) {
    keep_remedies(ramp->fit, now.fit);
    now = std::move(*ramp);
    now.fit.remedies.push_back(
        {"ramp",
         alarm,
         fmt::format("rate ramp added to the model; 2 ln L rises by {:.0f}", gain),
         1});
    now.fit.sentences.push_back(
        "The record drifts; a straight line was taken out of the random walk.");
    return;
  }
  const std::uint64_t count = now.bins.size() - dropped.bins.size();
  NoiseFit fit = dropped.fit;
  keep_remedies(fit, now.fit);
  fit.remedies.push_back(
      {"lowest_bins", alarm, fmt::format("the {} slowest bins left out of the fit", count), count});
  fit.sentences.push_back(
      "The slowest part of the record (warm-up, temperature or drift) does not look like noise and "
      "was left out of the fit.");
  now = {dropped.bins, dropped.options, std::move(fit), dropped.half_deviance};
}

void judge(NoiseFit& fit) {
  if (!(fit.goodness.p < 1e-3)) return;
  const auto worst = std::max_element(
      fit.residuals.begin(), fit.residuals.end(), [](const FitResidual& a, const FitResidual& b) {
        return std::abs(a.z) < std::abs(b.z);
      });
  fit.sentences.push_back(
      fmt::format("The model does not describe the record within its statistical accuracy "
                  "(chi-square {:.0f} for {:.0f} degrees of freedom, worst near {:.3g} Hz): the "
                  "intervals are those of the model and too narrow for the sensor.",
                  fit.goodness.chi2,
                  fit.goodness.dof,
                  worst->frequency_hz));
}

}  // namespace

NoiseFit fit_power_bins(const std::vector<PowerBin>& bins,
                        double rate_hz,
                        std::uint64_t samples,
                        const AllanCurve* allan,
                        const FitOptions& options,
                        FitWorkspace* workspace) {
  Attempt now = attempt(bins, rate_hz, samples, options);
  if (options.remedies) {
    answer_broad_peaks(now);
    answer_high_frequencies(now);
    answer_low_frequencies(now);
  }
  judge(now.fit);
  if (options.second_opinion && allan != nullptr)
    now.fit.second_opinion =
        second_opinion(*allan, now.fit, workspace != nullptr ? &workspace->covariances : nullptr);
  if (allan != nullptr) answer_contradictions(now.fit, *allan);
  return std::move(now.fit);
}

NoiseFit fit_binned(const PowerBinner& binner,
                    double rate_hz,
                    std::uint64_t samples,
                    const AllanCurve* allan,
                    const FitOptions& options,
                    FitWorkspace* workspace) {
  std::uint64_t clipped = 0;
  const std::vector<PowerBin> bins =
      options.remedies ? binner.finish_clipped(rate_hz, clipped) : binner.finish(rate_hz);
  NoiseFit fit = fit_power_bins(bins, rate_hz, samples, allan, options, workspace);
  if (clipped > 0) fit.remedies.insert(fit.remedies.begin(), lines_remedy(clipped));
  return fit;
}

NoiseFit fit_record(std::span<const double> record,
                    double rate_hz,
                    const AllanCurve* allan,
                    const FitOptions& options,
                    FitWorkspace* workspace) {
  const DespikedRecord despiked = options.remedies ? without_spikes(record) : DespikedRecord{};
  const std::span<const double> data =
      despiked.samples.empty() ? record : std::span<const double>(despiked.samples);
  AllanCurve own;  // a curve of the spikes is no opinion on what is left
  if (allan != nullptr && !despiked.samples.empty()) {
    AllanPyramid pyramid;
    pyramid.push(data);
    own = pyramid.finish(1 / rate_hz);
    allan = &own;
  }
  // One exact transform while it is cheap; a longer record goes by blocks.
  constexpr std::uint64_t kWhole = std::uint64_t{1} << 21U;
  const std::uint64_t block =
      data.size() <= kWhole ? std::max<std::uint64_t>(data.size(), 64) : std::uint64_t{1} << 16U;
  PowerBinner binner(block);
  const std::vector<double> filled = options.remedies ? bridged(data) : std::vector<double>{};
  binner.push(filled.empty() ? data : filled);
  NoiseFit fit =
      fit_binned(binner, rate_hz, record.size() - count_missing(record), allan, options, workspace);
  add_spike_answer(despiked.answer, fit);
  return fit;
}

}  // namespace libchar

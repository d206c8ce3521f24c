#include "libchar/fit/noise_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/coefficient.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/numeric/present.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/fit/curve/allan_fit.hpp"
#include "libchar/fit/curve/shaped_curves.hpp"
#include "libchar/fit/detail/band/band.hpp"
#include "libchar/fit/detail/band/band_report.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/detail/band/contradiction.hpp"
#include "libchar/fit/detail/band/goodness.hpp"
#include "libchar/fit/detail/band/neighbours.hpp"
#include "libchar/fit/detail/band/small_shape.hpp"
#include "libchar/fit/detail/curve/coefficients.hpp"
#include "libchar/fit/detail/curve/gauss_markov_fit.hpp"
#include "libchar/fit/detail/curve/polish.hpp"
#include "libchar/fit/detail/curve/power_law.hpp"
#include "libchar/fit/detail/record/dct_means.hpp"
#include "libchar/fit/detail/record/record_means.hpp"
#include "libchar/fit/record/power_bins.hpp"
#include "libchar/fit/remedies.hpp"

namespace libchar {

namespace {

constexpr double kMisfit = 1e-3;     ///< probability of the residuals below which the terms do not describe them
constexpr double kRampRatio = 5.41;  ///< the same for a ramp: passed by 0.5 % of clean records
constexpr double kProcessWorth = 6;  ///< of 2 lnL that a Gauss-Markov process must have before a power law
constexpr std::size_t kLowest = 5;   ///< coefficients that a warm-up or a drift falls into

constexpr auto kQuantization = static_cast<std::size_t>(Term::quantization);
constexpr auto kRamp = static_cast<std::size_t>(Term::ramp);

/// The bins, which of them are fitted, what is offered, and the fit; remedies change the last three.
struct Attempt {
  const std::vector<PowerBin>* bins = nullptr;
  Band band;
  FitOptions options;
  NoiseFit fit;
  double half_deviance = 0;
  ModelPoint best = {};
};

void require_enough(std::size_t bins, const TermSet& terms) {
  const std::size_t wanted = count_of(terms);
  if (wanted == 0) {
    throw usage_error("E0201").says("no noise term was asked for").hint("offer at least white noise");
  }
  if (bins >= wanted) return;
  throw numeric_error("E0401")
      .says("{} bins of the spectrum are fewer than the {} noise terms to fit", bins, wanted)
      .hint("use a longer record");
}

BinProblem problem_of(const std::vector<PowerBin>& bins, const Band& band, double rate_hz) {
  return band_problem(bins, band, rate_hz);
}

/// `report`: with coefficients, limits and residuals, not with theta and likelihood alone.
Attempt attempt(const std::vector<PowerBin>& bins, Band band, double rate_hz, std::uint64_t samples,
                const FitOptions& options, bool report = true) {
  Attempt out{&bins, std::move(band), options, {}, 0};
  if (out.band.bottom_hz > 0) out.options.terms = {true, false, false, false, false};
  if (out.band.quantized) out.options.terms[kQuantization] = true;
  if (out.band.tau_s) out.options.terms[kRamp] = true;
  if (out.band.faster_s) out.options.terms[kQuantization] = true;
  const BinProblem problem = problem_of(bins, out.band, rate_hz);
  require_enough(static_cast<std::size_t>(problem.size()), out.options.terms);
  const Decision decision = decide(problem, out.options.terms, options.threshold);
  NoiseFit& fit = out.fit;
  fit.rate_hz = rate_hz;
  fit.samples = samples;
  fit.duration_s = static_cast<double>(samples) / rate_hz;
  fit.search.method =
      fmt::format("DCT-II Whittle likelihood{}, {} bins", options.explain ? "" : " of the terms alone", problem.size());
  out.best = report ? report_coefficients(problem, decision, out.options, fit) : polish(problem, decision.at).at;
  fit.theta = out.best.theta;
  out.half_deviance = half_deviance(problem, out.best);
  if (!report) return out;
  if (out.band.small.amplitude != 0) {
    Band plain = out.band;
    plain.small = {};
    reach_limits(problem_of(bins, plain, rate_hz), out.options.terms, fit);
  }
  if (!out.band.tau_s && !options.clock) report_bounds(decision.kept, fit);
  describe_band(bins, out.band, problem, out.best, rate_hz, fit);
  fit.goodness = goodness_of(inside_of(fit.residuals), count_of(only_positive(fit.theta)) + unknowns_of(out.band));
  return out;
}

/// Goodness of the residuals between two frequencies.
Goodness goodness_between(const NoiseFit& fit, double low_hz, double high_hz) {
  std::vector<FitResidual> part;
  for (const FitResidual& residual : fit.residuals) {
    if (residual.inside && residual.frequency_hz >= low_hz && residual.frequency_hz <= high_hz)
      part.push_back(residual);
  }
  return goodness_of(part, 0);
}

Band without_lowest(const Attempt& now) {
  Band band = now.band;
  const double from_hz = (static_cast<double>(kLowest) - 0.5) / (2 * now.fit.duration_s);
  for (std::size_t j = 0; j < now.bins->size(); ++j)
    if (!((*now.bins)[j].low_hz > from_hz * (1 - 1e-9))) band.inside[j] = 0;
  return band;
}

/// 2 ln L by which the bins of `other` reject the theta of `fit`: small when the two are consistent.
double rejection(const Attempt& other, const NoiseFit& fit) {
  const BinProblem problem = problem_of(*other.bins, other.band, fit.rate_hz);
  const ModelPoint at{fit.theta, {}};
  const double value = problem.shapes() == 0 ? half_deviance(problem, at) : score(problem, {}, &at).half_deviance;
  return 2 * (value - other.half_deviance);
}

/// What `rejection` stays below in clean records. Its expectation is the information that the dropped bins carried,
/// tr(1 - I_dropped I^-1), nearly all in one direction, so that it scatters like that times a chi-square of one degree
/// of freedom. Below 1 the fit has moved by less than one standard deviation: not worth a remedy.
double rejection_limit(const Attempt& now, const Attempt& dropped) {
  const TermSet terms = only_positive(now.fit.theta);
  const auto information = [&](const Band& band) {
    const BinProblem problem = problem_of(*now.bins, band, now.fit.rate_hz);
    const ModelPoint at{now.fit.theta, {}};
    return fisher_information(problem, at, terms);
  };
  const TermMatrix all = information(now.band), rest = information(dropped.band);
  const double lost = static_cast<double>(count_of(terms)) - (rest * inverse_of(all, terms)).trace();
  return std::clamp(16 * lost, 1.0, 16.0);
}

/// Of a model that a record is impossible under, no double holds it.
std::string ratio_text(double ratio) {
  return std::isfinite(ratio) ? fmt::format("{:.1f}", ratio) : "beyond all numbers";
}

/// A drift falls into the first few coefficients: a ramp, or those coefficients left out.
void answer_low_frequencies(Attempt& now) {
  const Band rest = without_lowest(now);
  const auto left = static_cast<std::size_t>(std::count(rest.inside.begin(), rest.inside.end(), 1));
  if (left < 2 * count_of(now.options.terms) || rest.inside == now.band.inside) return;
  const Attempt dropped = attempt(*now.bins, rest, now.fit.rate_hz, now.fit.samples, now.options, false);
  const double rejects = rejection(dropped, now.fit);
  const double limit = rejection_limit(now, dropped);
  const Goodness low = goodness_between(now.fit, 0, (kLowest + 0.5) / (2 * now.fit.duration_s));
  FitOptions with = now.options;
  with.terms[kRamp] = true;
  std::optional<Attempt> ramp;
  if (!now.options.terms[kRamp]) ramp = attempt(*now.bins, now.band, now.fit.rate_hz, now.fit.samples, with, false);
  const double gain = ramp ? 2 * (now.half_deviance - ramp->half_deviance) : 0;
  if (std::isnan(rejects)) return;  // there is no likelihood to hold them against
  if (rejects < limit && low.p > 1e-3 && gain < kRampRatio) return;

  const std::string alarm =
      fmt::format("the slowest {} coefficients do not follow the rest (2 ln L {}; with a ramp {})", kLowest - 1,
                  ratio_text(rejects), ratio_text(gain));
  const bool ramp_likely = ramp && gain > kRampRatio && rejection(dropped, ramp->fit) < limit;
  if (ramp_likely) ramp = attempt(*now.bins, now.band, now.fit.rate_hz, now.fit.samples, with);
  const bool ramp_explains =
      ramp_likely && goodness_between(ramp->fit, 0, (kLowest + 0.5) / (2 * now.fit.duration_s)).p > 0.005;
  if (ramp_explains) {
    ramp->fit.remedies = now.fit.remedies;
    now = std::move(*ramp);
    now.fit.remedies.push_back(
        {"ramp", alarm, fmt::format("rate ramp added to the model; 2 ln L rises by {:.0f}", gain), 1});
    now.fit.findings.push_back(
        finding("drift", "The record drifts; a straight line was taken out of the random walk."));
    return;
  }
  const auto count = static_cast<std::uint64_t>(std::count(now.band.inside.begin(), now.band.inside.end(), 1) -
                                                std::count(rest.inside.begin(), rest.inside.end(), 1));
  const std::vector<Remedy> before = now.fit.remedies;
  now = attempt(*now.bins, rest, now.fit.rate_hz, now.fit.samples, now.options);
  now.fit.remedies = before;
  now.fit.remedies.push_back(
      {"lowest_bins", alarm, fmt::format("the {} slowest bins left out of the fit", count), count});
  now.fit.findings.push_back(finding("lowest_left_out",
                                     "The slowest part of the record (warm-up, temperature or drift) does not look "
                                     "like noise and was left out of the fit.",
                                     "the slowest part does not look like noise and was left out"));
}

/// What the Allan curve allows of a term alone: it would nowhere stand above the upper end of what was measured.
double largest_possible(Term term, const AllanCurve& allan) {
  double largest = std::numeric_limits<double>::infinity();
  for (const AllanPoint& point : allan.points) {
    if (!(point.deviation > 0) || !(point.ci95.high > 0)) continue;
    const double unit = std::sqrt(unit_allan_variance(term, static_cast<double>(point.m), allan.dt_s));
    if (unit > 0) largest = std::min(largest, point.ci95.high / unit);
  }
  return largest;
}

/// Where the terms do not describe the record its scatter is larger than theirs: intervals by as
/// much, and limits not below what the measured curve leaves room for.
void admit_misfit(NoiseFit& fit, const AllanCurve* allan) {
  AllanCurve curve = allan != nullptr ? *allan : AllanCurve{};
  if (deviation_row(curve.type).is_allan())
    add_fit_intervals(curve, fit);
  else
    curve.points.clear();
  const double wider = std::sqrt(std::max(1.0, fit.goodness.chi2 / std::max(1.0, fit.goodness.dof)));
  widen_as_misfit(wider, fit);
  for (std::size_t i = 0; i < kTerms; ++i) {
    Coefficient& term = fit.term[i];
    const double possible = largest_possible(static_cast<Term>(i), curve);
    if (!term.upper95 || !std::isfinite(possible)) continue;
    term.upper95 = std::max(*term.upper95, possible);
    term.ci95.high = std::max(term.ci95.high, *term.upper95);
  }
}

/// Of slow noise a hump leaves a limit alone: it is nowhere above what was measured.
double largest_beneath(Term term, const std::vector<PowerBin>& bins) {
  constexpr double kFewestDof = 8, kTail = 0.05;
  double largest = std::numeric_limits<double>::infinity();
  for (const PowerBin& bin : bins) {
    const double unit = bin.unit[static_cast<std::size_t>(term)];
    if (bin.dof < kFewestDof || !(unit > 0)) continue;
    const double upper = bin.energy * bin.dof / chi_square_quantile(kTail, bin.dof);
    largest = std::min(largest, std::sqrt(upper / unit));
  }
  return largest;
}

void answer_hump(const std::vector<PowerBin>& bins, double bottom_hz, const TermSet& asked, NoiseFit& fit) {
  for (const Term slow : {Term::flicker, Term::walk}) {
    const double largest = largest_beneath(slow, bins);
    if (!asked[static_cast<std::size_t>(slow)] || !std::isfinite(largest)) continue;
    Coefficient& term = fit.term[static_cast<std::size_t>(slow)] = {};
    term.status = Status::not_detected;
    term.upper95 = largest;
    term.ci95 = {0, largest};
  }
  Finding hump = finding("hump",
                         fmt::format("Below {} no noise term describes the record (a cycle, a movement, the "
                                     "temperature): N is estimated above it; B and K have only limits.",
                                     detail::frequency_text(bottom_hz)),
                         "its slow part is not noise");
  hump.where.frequency_hz.push_back({0, bottom_hz});
  fit.findings.push_back(std::move(hump));
}

/// A cut band says of white noise what its slow part shows; a limit below the whole spectrum above
/// it would be a statement about frequencies that were not looked at.
void raise_white_limit(NoiseFit& fit) {
  constexpr double kFewestDof = 30;
  Coefficient& white = fit.term[static_cast<std::size_t>(Term::white)];
  double least = std::numeric_limits<double>::infinity();
  for (const FitResidual& residual : fit.residuals)
    if (!residual.inside && residual.frequency_hz > fit.band.top_hz && residual.dof > kFewestDof)
      least = std::min(least, residual.measured);
  if (!white.upper95 || !std::isfinite(least) || !(std::sqrt(least) > *white.upper95)) return;
  white.upper95 = std::sqrt(least);
  white.ci95.high = std::max(white.ci95.high, *white.upper95);
}

void judge(NoiseFit& fit, bool passes, bool in_any_band, const AllanCurve* allan) {
  raise_white_limit(fit);
  if (passes && !(fit.goodness.p < kMisfit)) return;
  admit_misfit(fit, allan);
  const auto worst =
      std::max_element(fit.residuals.begin(), fit.residuals.end(), [](const FitResidual& a, const FitResidual& b) {
        return (a.inside ? std::abs(a.z) : 0) < (b.inside ? std::abs(b.z) : 0);
      });
  fit.findings.push_back(
      finding("misfit",
              fmt::format("The model does not describe the record within its statistical accuracy (chi-square {:.0f} "
                          "for {:.0f} degrees of freedom, worst near {}){}: the intervals are widened by its "
                          "scatter, and the data support no coefficient.",
                          fit.goodness.chi2, fit.goodness.dof, detail::frequency_text(worst->frequency_hz),
                          in_any_band ? ", in any band" : ""),
              "the noise terms do not describe the recording"));
}

/// After the decisions: the process that was needed gets its intervals, one that is as likely a sentence.
void answer_process(const std::vector<PowerBin>& bins, const Band& band, GaussMarkovChoice& process, NoiseFit& fit) {
  if (!process.needed) return report_not_needed(process, fit);
  process.band = band;
  settle_gauss_markov(bins, process, fit);
}

/// What was fitted in the ramp's column is flicker phase noise; bounds are what the fit's covariance says.
void settle_flicker_phase(NoiseFit& fit) {
  for (Coefficient& term : fit.term)
    if (term.value) term.bound = term.relative_sd;
  fit.flicker_phase = fit.term[kRamp];
  fit.term[kRamp] = {};
  fit.theta[kRamp] = 0;
  for (std::size_t i = 0; i < kTerms; ++i) fit.covariance[i][kRamp] = fit.covariance[kRamp][i] = 0;
}

/// A law takes the place of the terms that stand in for it: they would bend with the shapes.
void average_over_shapes(Attempt& now) {
  const SlowLaw* law = now.band.law ? &*now.band.law : nullptr;
  const std::vector<PowerBin> bins = law != nullptr ? with_law(*now.bins, *law) : *now.bins;
  average_over_small_shapes(bins, now.band, problem_of(bins, now.band, now.fit.rate_hz),
                            law != nullptr ? ModelPoint{law->theta(), {}} : now.best, now.fit);
}

/// The process has two parameters where the law has none beside its exponent; a law that needs no shape stands before a
/// process that does.
bool is_likelier(const GaussMarkovChoice& process, const PowerLawChoice& law) {
  if (process.band.inside == law.band.inside && process.band.orders == law.band.orders)
    return process.half_deviance + kProcessWorth / 2 < law.half_deviance;
  return law.band.orders > 0 && process.likelihood_ratio > law.likelihood_ratio + kProcessWorth;
}

NoiseFit fit_offered(const std::vector<PowerBin>& bins, double rate_hz, std::uint64_t samples, const AllanCurve* allan,
                     const FitOptions& options, FitWorkspace* workspace) {
  Band band;
  BandOptions band_options;
  band_options.small_shapes = !options.clock && !options.white_top;
  band_options.corners = !options.clock;
  const bool explains = options.remedies && options.explain;
  if (explains)
    band = find_band(bins, rate_hz, options.terms, band_options);
  else
    band = whole_band(bins, rate_hz);
  std::optional<GaussMarkovChoice> process;
  const bool hump = band.bottom_hz > 0;
  if (explains && options.gauss_markov && !options.clock && !hump)
    process = choose_gauss_markov(bins, band, rate_hz, static_cast<double>(samples) / rate_hz, options.terms);
  std::optional<PowerLawChoice> law;
  if (process) law = choose_power_law(bins, band, rate_hz, options.terms);
  if (law && process->needed && (!law->needed || is_likelier(*process, *law))) law.reset();
  const std::optional<PowerLawChoice> possible = law && !law->needed ? law : std::nullopt;
  if (possible) law.reset();
  if (law) process.reset();
  if (law) band = law->band;
  if (process) band = process->band;
  Attempt now = attempt(bins, std::move(band), rate_hz, samples, options);
  if (now.band.tau_s) {  // once more at the best correlation time of the terms that stay
    process->tau_s = *(now.band.tau_s = likeliest_tau(bins, now.band, rate_hz, now.fit.theta));
    now = attempt(bins, now.band, rate_hz, samples, options);
  }
  if (explains) {
    report_band(now.band, bins, now.fit);
    if (hump) answer_hump(bins, now.band.bottom_hz, options.terms, now.fit);
    if (!now.band.law) answer_low_frequencies(now);
    report_corner(now.band, now.fit);
    if (law) answer_power_law(*law, now.fit);
    if (band_options.small_shapes && !law) reach_to_neighbours(bins, now.band, now.best, options.terms, now.fit);
    if (now.band.doubtful_end && !law && !(process && process->needed)) report_doubtful_end(now.fit);
    if (band_options.small_shapes && now.band.passes) average_over_shapes(now);
    if (band_options.small_shapes && possible) reach_to_law(*possible, now.fit);
  }
  judge(now.fit, now.band.passes, explains, allan);
  if (process) answer_process(bins, now.band, *process, now.fit);
  if (options.clock) settle_flicker_phase(now.fit);
  // An Allan curve has no way of saying what lies behind a high-pass.
  const bool behind = now.band.named.family == NamedShape::Family::high_pass;
  const bool terms_alone = !behind && !hump && !(now.fit.gauss_markov && now.fit.gauss_markov->in_model) &&
                           !(now.fit.flicker_phase && now.fit.flicker_phase->value);
  if (options.second_opinion && options.explain && allan != nullptr && terms_alone)
    now.fit.second_opinion = second_opinion(*allan, now.fit, workspace != nullptr ? &workspace->covariances : nullptr);
  if (allan != nullptr && !behind && !hump) answer_contradictions(now.fit, *allan);
  constexpr double kNoEnd = 1000;  // times the value: a shape takes all of it back, up to any number
  for (Coefficient& term : now.fit.term)
    if (term.value && term.ci95.high > kNoEnd * *term.value) {
      term.ci95.high = std::numeric_limits<double>::infinity();
      if (term.status == Status::detected) term.status = Status::undetermined;
    }
  now.fit.bins = bins;
  return std::move(now.fit);
}

}  // namespace

void widen_as_misfit(double wider, NoiseFit& fit) {
  for (auto& row : fit.covariance)
    for (double& value : row) value *= wider * wider;
  for (Coefficient& term : fit.term) {
    if (term.upper95) {
      *term.upper95 *= wider;
      term.ci95.high = std::max(term.ci95.high, *term.upper95);
    }
    if (!term.value) continue;
    term.status = Status::misfit;
    term.relative_sd *= wider;
    term.ci95.high = *term.value * std::pow(term.ci95.high / *term.value, wider);
    term.ci95.low = *term.value * std::pow(std::max(term.ci95.low, 0.0) / *term.value, wider);
  }
}

NoiseFit fit_power_bins(const std::vector<PowerBin>& bins, double rate_hz, std::uint64_t samples,
                        const AllanCurve* allan, const FitOptions& options, FitWorkspace* workspace) {
  if (!options.clock) return fit_offered(bins, rate_hz, samples, allan, options, workspace);
  std::vector<PowerBin> lent = bins;
  lend_flicker_phase(rate_hz, lent);
  FitOptions offered = options;
  offered.terms[kRamp] = offered.terms[kQuantization] = true;
  return fit_offered(lent, rate_hz, samples, allan, offered, workspace);
}

NoiseFit fit_powers(std::span<const PooledPower> powers, double rate_hz, std::uint64_t samples, const AllanCurve* allan,
                    const FitOptions& options, FitWorkspace* workspace, std::span<const double> spent) {
  ClippedBins lines;
  if (options.remedies)
    lines = clipped_power_bins(powers, rate_hz);
  else
    lines.bins = power_bins(powers, rate_hz);
  if (!spent.empty()) count_spent(spent, static_cast<double>(samples) / rate_hz, lines.bins);
  FitOptions chosen = options;
  // The cycles are in the Allan curve: no opinion on what is left.
  chosen.second_opinion = options.second_opinion && lines.cycles.empty();
  const auto is_beyond = [&](const PowerBin& bin) {
    return options.at_rest->excess(bin.frequency_hz, bin.energy / rate_hz, bin.dof) > 1;
  };
  if (options.at_rest && std::any_of(lines.bins.begin(), lines.bins.end(), is_beyond)) chosen.explain = false;
  NoiseFit fit = fit_power_bins(lines.bins, rate_hz, samples, allan, chosen, workspace);
  if (!lines.cycles.empty()) fit.findings.push_back(detail::cycle_finding(lines.cycles));
  fit.cycles = std::move(lines.cycles);
  if (lines.clipped == 0) return fit;
  add_lines(lines.bins, lines.all, fit);
  // An Allan curve cannot leave a line out: it is no opinion on the noise then.
  constexpr double kInAllan = 0.02;
  const bool in_allan = fit.second_opinion && !fit.second_opinion->agrees && detail::share_of_lines(lines) > kInAllan;
  if (in_allan) fit.second_opinion.reset();
  fit.findings.push_back(detail::lines_finding(lines, in_allan));
  fit.remedies.insert(fit.remedies.begin(), lines_remedy(lines.clipped));
  return fit;
}

}  // namespace libchar

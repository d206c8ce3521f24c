#include "libchar/fit/coefficients.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/fit/bounds.hpp"
#include "libchar/fit/profile.hpp"

namespace libchar {
namespace {

constexpr double kUndeterminedAbove =
    0.30;  ///< bound above which a term counts as not determined (accuracy.md 6)
constexpr double kNormal95 = 1.959963984540054;

double sd_of_theta(const BinProblem& problem, Mixture theta, TermSet terms, std::size_t term) {
  terms[term] = true;
  const TermMatrix covariance = inverse_of(fisher_information(problem, theta, terms), terms);
  return std::sqrt(covariance(static_cast<Eigen::Index>(term), static_cast<Eigen::Index>(term)));
}

Interval interval_of(const BinProblem& problem,
                     const TermSet& terms,
                     const Optimum& best,
                     std::size_t term,
                     double sd,
                     bool& profile,
                     double profile_above) {
  const double value = std::sqrt(best.theta[term]);
  profile = sd / 2 > profile_above;
  if (!profile)
    return {value * std::exp(-kNormal95 * sd / 2), value * std::exp(kNormal95 * sd / 2)};
  const double sd_theta = sd * best.theta[term];
  return {std::sqrt(profile_lower(problem, terms, best, term, sd_theta, kTwoSided95)),
          std::sqrt(profile_upper(problem, terms, best, term, sd_theta, kTwoSided95))};
}

/// One-sided limit of a term that has no value: it is put back into the model for that.
double upper_limit(const BinProblem& problem,
                   TermSet terms,
                   const Optimum& reported,
                   std::size_t term) {
  terms[term] = true;
  const ScoringResult with = score(problem, terms);
  const Optimum best = with.half_deviance <= reported.half_deviance
                           ? Optimum{with.theta, with.half_deviance}
                           : reported;
  return std::sqrt(profile_upper(
      problem, terms, best, term, sd_of_theta(problem, best.theta, terms, term), kOneSided95));
}

}  // namespace

std::string people_name(Term term) {
  static constexpr std::array<std::string_view, kTerms> names = {
      "white noise", "bias instability", "random walk", "quantization noise", "rate ramp"};
  const auto i = static_cast<std::size_t>(term);
  return fmt::format("{} {}", names[i], kTermNames[i].letter);
}

void report_coefficients(const BinProblem& problem,
                         const Decision& decision,
                         const FitOptions& options,
                         NoiseFit& fit) {
  const Polished polished = polish(problem, decision.theta);
  fit.theta = polished.theta;
  fit.converged = decision.converged && polished.converged;
  fit.iterations = decision.iterations + polished.iterations;
  const Optimum best{polished.theta, polished.half_deviance};
  for (std::size_t i = 0; i < kTerms; ++i) {
    for (std::size_t j = 0; j < kTerms; ++j) {
      fit.covariance[i][j] =
          polished.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  }
  for (std::size_t i = 0; i < kTerms; ++i) {
    Coefficient& term = fit.term[i];
    term = {};
    if (!options.terms[i]) continue;
    term.likelihood_ratio = decision.likelihood_ratio[i];
    const bool ambiguous =
        decision.flicker_or_walk &&
        (i == static_cast<std::size_t>(Term::flicker) || i == static_cast<std::size_t>(Term::walk));
    if (!(fit.theta[i] > 0)) {
      term.status = decision.kept[i] && ambiguous ? Status::undetermined : Status::not_detected;
      term.upper95 = upper_limit(problem, decision.kept, best, i);
      continue;
    }
    const double sd = std::sqrt(fit.covariance[i][i]);
    term.status = ambiguous ? Status::undetermined : Status::detected;
    term.value = std::sqrt(fit.theta[i]);
    term.relative_sd = sd / 2;
    term.ci95 =
        interval_of(problem, decision.kept, best, i, sd, term.profile, options.profile_above);
  }
  if (decision.flicker_or_walk) {
    fit.sentences.push_back(
        "The record shows slow noise but cannot tell bias instability from random walk: each could "
        "explain it alone. A longer record can tell.");
  }
}

void report_bounds(const TermSet& fitted, NoiseFit& fit) {
  const auto bound = cramer_rao(fit.theta, fit.rate_hz, static_cast<double>(fit.samples), fitted);
  for (std::size_t i = 0; i < kTerms; ++i) {
    Coefficient& term = fit.term[i];
    if (!term.value || !bound[i]) continue;
    term.bound = bound[i];
    if (*bound[i] > kUndeterminedAbove && term.status == Status::detected) {
      term.status = Status::undetermined;
      fit.sentences.push_back(
          fmt::format("The record is too short for {}: at best it is known to {:.0f} % (1 sd).",
                      people_name(static_cast<Term>(i)),
                      100 * *bound[i]));
    }
    term.seconds_for_10_percent =
        seconds_for(static_cast<Term>(i), 0.10, fit.theta, fit.rate_hz, fitted);
  }
}

}  // namespace libchar

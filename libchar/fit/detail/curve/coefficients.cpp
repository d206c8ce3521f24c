#include "libchar/fit/detail/curve/coefficients.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "libchar/core/text/readable.hpp"
#include "libchar/fit/curve/bounds.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/detail/curve/profile.hpp"

namespace libchar {

// A term whose true value is zero improves 2 ln L by half a chi-square with one degree of freedom and half a zero
// (boundary of theta >= 0): threshold 5.41 is passed by 1 % of such terms. Elimination runs backward from the full set,
// least needed first. Neighbours may each be dispensable while the other is there and yet not both
// (docs/theory/fit.md): then both are kept and reported as undetermined.

namespace {

/// Maxima of all submodels, each computed once when asked for.
class Submodels {
 public:
  explicit Submodels(const BinProblem& problem) : problem_(problem) {}

  const ScoringResult& at(const TermSet& set) {
    std::size_t key = 0;
    for (std::size_t i = 0; i < kTerms; ++i) key |= set[i] ? std::size_t{1} << i : 0;
    if (!known_[key]) {
      known_[key] = score(problem_, set);
      iterations += known_[key]->iterations;
    }
    return *known_[key];
  }

  /// 2 (lnL of `set` with the term - lnL of `set` without it).
  double ratio(TermSet set, std::size_t term) {
    set[term] = true;
    const double with = at(set).half_deviance;
    set[term] = false;
    if (count_of(set) == 0) return std::numeric_limits<double>::infinity();
    const double without = at(set).half_deviance;
    return std::isfinite(without) ? std::max(0.0, 2 * (without - with)) : std::numeric_limits<double>::infinity();
  }

  int iterations = 0;

 private:
  const BinProblem& problem_;
  std::array<std::optional<ScoringResult>, 1U << kTerms> known_;
};

/// Neighbours by their slopes, of which one can do for the other.
struct Neighbours {
  Term faster, slower;
  const char* code;
  const char* sentence;
};
constexpr std::array<Neighbours, 2> kNeighbours = {{
    {Term::flicker, Term::walk, "flicker_or_walk",
     "The record shows slow noise but cannot tell bias instability from random walk: "
     "each could explain it alone. A longer record can tell."},
    {Term::white, Term::flicker, "white_or_flicker",
     "The record cannot tell white noise from bias instability: each could explain it alone. A longer record can "
     "tell."},
}};

bool cannot_tell(Submodels& models, const TermSet& set, const Neighbours& pair, double threshold) {
  const auto a = static_cast<std::size_t>(pair.faster), b = static_cast<std::size_t>(pair.slower);
  if (!set[a] || !set[b]) return false;
  TermSet neither = set;
  neither[a] = neither[b] = false;
  if (count_of(neither) == 0) return false;
  const double both = 2 * (models.at(neither).half_deviance - models.at(set).half_deviance);
  return models.ratio(set, a) < threshold && models.ratio(set, b) < threshold && both > threshold;
}

}  // namespace

Decision decide(const BinProblem& problem, const TermSet& offered, double threshold) {
  Submodels models(problem);
  Decision decision;
  TermSet set = offered;
  for (;;) {
    for (std::size_t p = 0; p < kNeighbours.size() && threshold > 0; ++p)
      if (cannot_tell(models, set, kNeighbours[p], threshold)) {
        decision.either[p] = true;
        for (const Term term : {kNeighbours[p].faster, kNeighbours[p].slower})
          decision.ambiguous[static_cast<std::size_t>(term)] = true;
      }
    std::size_t weakest = kTerms;
    double least = threshold;
    for (std::size_t i = 0; i < kTerms && count_of(set) > 1; ++i) {
      if (!set[i] || decision.ambiguous[i]) continue;
      const double ratio = models.ratio(set, i);
      if (ratio < least) {
        least = ratio;
        weakest = i;
      }
    }
    if (weakest == kTerms) break;
    set[weakest] = false;
  }
  const ScoringResult& best = models.at(set);
  decision.kept = set;
  decision.at = best.at;
  decision.half_deviance = best.half_deviance;
  decision.converged = best.converged;
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (!offered[i]) continue;
    decision.likelihood_ratio[i] = models.ratio(set, i);
    decision.ratio_in_all[i] = models.ratio(offered, i);
  }
  decision.iterations = models.iterations;
  return decision;
}

namespace {

constexpr double kUndeterminedAbove = 0.30;  ///< bound above which a term counts as not determined (docs/theory/fit.md)
/// Relative sd below which a dropped term moves no interval (white noise).
constexpr double kWellKnown = 0.01;

double sd_of_theta(const BinProblem& problem, const ModelPoint& at, TermSet terms, std::size_t term) {
  terms[term] = true;
  const TermMatrix covariance = inverse_of(fisher_information(problem, at, terms), terms);
  return std::sqrt(covariance(static_cast<Eigen::Index>(term), static_cast<Eigen::Index>(term)));
}

Interval profile_interval(const BinProblem& problem, const TermSet& terms, const Optimum& best, std::size_t term,
                          double lower_rise) {
  const double sd = sd_of_theta(problem, best.at, terms, term);
  return {std::sqrt(profile_lower(problem, terms, best, term, sd, lower_rise)),
          std::sqrt(profile_upper(problem, terms, best, term, sd, kEachTail))};
}

/// The model of all terms that were offered. A dropped term is not known to be zero: without it the intervals of the
/// others would pretend that the decision was certain (coverage 85 % instead of 95 % in scene a2 of the theory page).
struct WithDropped {
  TermSet terms{};
  Optimum best;
  bool any = false;
};

WithDropped with_dropped(const BinProblem& problem, const Decision& decision, const Optimum& reported,
                         const TermSet& offered) {
  WithDropped all;
  all.terms = offered;
  all.best = reported;
  all.any = offered != decision.kept;
  if (all.any) {
    const ScoringResult full = score(problem, all.terms);
    all.best = {full.at, full.half_deviance};
  }
  return all;
}

/// One step of Fisher scoring from the maximum over theta >= 0, which lets dropped terms below zero: an efficient
/// estimate of each theta that no bound and no decision biases (van der Vaart, Asymptotic Statistics (1998), 5.7).
///   theta = theta_max + I^-1 g,   g_i = sum nu/2 (u - 1) a_i / mu
void report_in_all(const BinProblem& problem, const WithDropped& all, Coefficients& terms) {
  const ModelPoint& at = all.best.at;
  const TermMatrix covariance = inverse_of(fisher_information(problem, at, all.terms), all.terms);
  const Eigen::ArrayXd model = model_of(problem, at);
  const Eigen::ArrayXd shape = shape_of(problem, at.shape);
  const Eigen::ArrayXd slope = problem.dof / 2 * (problem.energy / model - 1) * shape / model;
  Eigen::Matrix<double, kTerms, 1> gradient;
  for (std::size_t i = 0; i < kTerms; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    gradient[k] = all.terms[i] ? (slope * problem.unit.col(k)).sum() : 0;
  }
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (!all.terms[i]) continue;
    const ScoreMoments moments = score_moments(problem, at, all.terms, i);
    terms[i].in_all = SquareInAll{at.theta[i] + covariance.row(static_cast<Eigen::Index>(i)).dot(gradient), moments.sd,
                                  moments.skewness};
  }
}

/// Rise of the lower limit of a term that is reported because its likelihood ratio passed the threshold, and called
/// detected because its relative sd is below kUndeterminedAbove: the stricter of the two, the second on the scale of
/// the root of the ratio, which grows about as the inverse of the relative sd.
double lower_rise(double ratio, double relative_sd, double threshold) {
  const double bound = relative_sd / kUndeterminedAbove;
  return selected_rise(ratio, bound < 1 ? std::max(threshold, ratio * bound * bound) : threshold);
}

/// Limits of a term that has no value: it is put back into the model for that, alone and with all that were offered.
void report_limits(const BinProblem& problem, TermSet terms, const Optimum& reported, const WithDropped& all,
                   std::size_t i, Coefficient& term) {
  terms[i] = true;
  const ScoringResult with = score(problem, terms);
  const bool better = with.half_deviance <= reported.half_deviance;
  const Optimum best = better ? Optimum{with.at, with.half_deviance} : reported;
  const double sd = sd_of_theta(problem, best.at, terms, i);
  const auto limit = [&](double tail) {
    const double alone = profile_upper(problem, terms, best, i, sd, tail);
    const bool more = all.any && all.terms != terms;
    return std::sqrt(more ? profile_upper(problem, all.terms, all.best, i, sd, tail, alone) : alone);
  };
  term.upper95 = limit(2 * kEachTail);
  term.ci95 = {0, limit(kEachTail)};
  term.profile = true;
}

/// A term whose neighbour may explain the same: its interval reaches as far up as without that.
void join_alone(const BinProblem& problem, const Decision& decision, std::size_t i, Coefficient& term) {
  TermSet alone = decision.kept;
  for (std::size_t p = 0; p < kNeighbours.size(); ++p) {
    const auto a = static_cast<std::size_t>(kNeighbours[p].faster), b = static_cast<std::size_t>(kNeighbours[p].slower);
    if (decision.either[p] && (i == a || i == b)) alone[i == a ? b : a] = false;
  }
  const ScoringResult found = score(problem, alone);
  Coefficient limits;
  report_limits(problem, alone, {found.at, found.half_deviance}, {}, i, limits);
  term.ci95.high = std::max(term.ci95.high, limits.ci95.high);
  if (term.upper95) term.upper95 = std::max(*term.upper95, *limits.upper95);
}

}  // namespace

void widen_by(double relative_sd, Coefficient& term) {
  const double value = *term.value;
  const auto wider = [&](double side) { return std::exp(std::hypot(std::log(side), kNormal95 * relative_sd)); };
  term.relative_sd = std::hypot(term.relative_sd, relative_sd);
  term.ci95 = {value / wider(value / std::max(term.ci95.low, 0.0)), value * wider(term.ci95.high / value)};
}

std::string long_name(Term term) {
  static constexpr std::array<std::string_view, kTerms> names = {"white noise", "bias instability", "random walk",
                                                                 "quantization noise", "rate ramp"};
  const auto i = static_cast<std::size_t>(term);
  return fmt::format("{} {}", names[i], kTermNames[i].letter);
}

namespace {

/// Terms that are so far from the record that its likelihood has no curvature there say nothing of how well
/// they are known.
void report_undetermined(Term which, NoiseFit& fit) {
  constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();
  Coefficient& term = fit.term[static_cast<std::size_t>(which)];
  term.status = Status::undetermined;
  term.ci95 = {kNotKnown, kNotKnown};
  term.upper95 = kNotKnown;
  fit.findings.push_back(finding(
      "undetermined", fmt::format("The record does not determine {}: the terms that were offered describe it nowhere.",
                                  long_name(which))));
}

}  // namespace

ModelPoint report_coefficients(const BinProblem& problem, const Decision& decision, const FitOptions& options,
                               NoiseFit& fit) {
  const Polished polished = polish(problem, decision.at);
  fit.theta = polished.at.theta;
  fit.search.converged = !polished.known || polished.ended || (decision.converged && polished.converged);
  fit.search.iterations = decision.iterations + polished.iterations;
  const Optimum best{polished.at, polished.half_deviance};
  const WithDropped all = with_dropped(problem, decision, best, options.terms);
  for (std::size_t i = 0; i < kTerms; ++i) {
    for (std::size_t j = 0; j < kTerms; ++j) {
      fit.covariance[i][j] = polished.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  }
  for (std::size_t i = 0; i < kTerms; ++i) {
    Coefficient& term = fit.term[i];
    term = {};
    if (!options.terms[i]) continue;
    term.likelihood_ratio = decision.likelihood_ratio[i];
    const bool ambiguous = decision.ambiguous[i];
    if (!(fit.theta[i] > 0)) {
      term.status = decision.kept[i] && ambiguous ? Status::undetermined : Status::not_detected;
      report_limits(problem, decision.kept, best, all, i, term);
      continue;
    }
    if (!polished.known) {
      report_undetermined(static_cast<Term>(i), fit);
      continue;
    }
    const double sd = std::sqrt(fit.covariance[i][i]);
    term.status = ambiguous ? Status::undetermined : Status::detected;
    term.value = std::sqrt(fit.theta[i]);
    term.relative_sd = sd / 2;
    const double spread = std::exp(kNormal95 * sd / 2);
    term.ci95 = {*term.value / spread, *term.value * spread};
    term.profile = ambiguous || term.relative_sd > options.profile_above;
    const double rise =
        ambiguous ? kTwoSided95 : lower_rise(decision.ratio_in_all[i], term.relative_sd, options.threshold);
    if (term.profile) term.ci95 = profile_interval(problem, decision.kept, best, i, rise);
    if (all.any && term.relative_sd > kWellKnown) {
      const Interval wide = profile_interval(problem, all.terms, all.best, i, rise);
      term.ci95 = {std::min(term.ci95.low, wide.low), std::max(term.ci95.high, wide.high)};
      term.profile = true;
    }
  }
  for (std::size_t i = 0; i < kTerms; ++i)
    if (options.terms[i] && decision.ambiguous[i]) join_alone(problem, decision, i, fit.term[i]);
  report_in_all(problem, all, fit.term);
  for (std::size_t p = 0; p < kNeighbours.size(); ++p)
    if (decision.either[p]) fit.findings.push_back(finding(kNeighbours[p].code, kNeighbours[p].sentence));
  return best.at;
}

void reach_limits(const BinProblem& other, const TermSet& offered, NoiseFit& fit) {
  const ScoringResult found = score(other, offered);
  const Optimum best{found.at, found.half_deviance};
  for (std::size_t i = 0; i < kTerms; ++i) {
    Coefficient& term = fit.term[i];
    if (!offered[i]) continue;
    const bool slow = i == static_cast<std::size_t>(Term::flicker) || i == static_cast<std::size_t>(Term::walk);
    if (slow && term.value && term.profile) {
      const Interval wide = profile_interval(other, offered, best, i, kTwoSided95);
      term.ci95 = {std::min(term.ci95.low, wide.low), std::max(term.ci95.high, wide.high)};
    }
    if (term.value || !term.upper95 || !std::isfinite(*term.upper95)) continue;
    const double sd = sd_of_theta(other, found.at, offered, i);
    const auto reach = [&](double limit, double tail) {
      return std::sqrt(profile_upper(other, offered, best, i, sd, tail, limit * limit));
    };
    term.upper95 = reach(*term.upper95, 2 * kEachTail);
    term.ci95.high = reach(term.ci95.high, kEachTail);
  }
}

void widen_for_joint_parameter(const Mixture& log_theta_sd, NoiseFit& fit) {
  for (std::size_t i = 0; i < kTerms; ++i) {
    Coefficient& term = fit.term[i];
    if (!term.value || !(log_theta_sd[i] / 2 > term.relative_sd)) continue;
    term.relative_sd = log_theta_sd[i] / 2;
    const double spread = std::exp(kNormal95 * term.relative_sd);
    term.ci95 = {std::min(term.ci95.low, *term.value / spread), std::max(term.ci95.high, *term.value * spread)};
    const double ratio = log_theta_sd[i] / std::sqrt(fit.covariance[i][i]);
    for (std::size_t j = 0; j < kTerms; ++j) {
      fit.covariance[i][j] *= ratio;
      fit.covariance[j][i] *= ratio;
    }
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
      fit.findings.push_back(
          finding("too_short", fmt::format("The record is too short for {}: at best it is known to {} (1 sd).",
                                           long_name(static_cast<Term>(i)), percent_text(*bound[i]))));
    }
    term.seconds_for_10_percent = seconds_for(static_cast<Term>(i), 0.10, fit.theta, fit.rate_hz, fitted);
  }
}

}  // namespace libchar

// The limits are the roots of 2 (lnL_max - max over the others of lnL(theta)) = rise, sought in the
// signed root of the left side, which is nearly linear in ln theta: the secant with a bracket needs
// four or five profile points, each a warm-started scoring of the other terms.
//
// Under theta the left side is a chi-square of one degree of freedom only where many coefficients of the spectrum see
// the term. Of the mean x of nu squares it is nu (x - 1 - ln x) exactly, and what lies below a limit with the
// probability `tail` is
//   rise = nu (q - 1 - ln q),   nu q the quantile `tail` of chi-square with nu degrees of freedom:
// 2.71 for many, 4.0 for two (tail 5 %). The efficient score of a term has the skewness sqrt(8/nu) of such a mean,
// whatever share of the coefficients it has; so that nu is that of the limit at hand (Barndorff-Nielsen and Cox,
// Inference and Asymptotics (1994), 5.2: the skewness of the score is what the first-order law leaves out).

#include "libchar/fit/detail/curve/profile.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libchar/core/numeric/distributions.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"

namespace libchar {

// A term is reported when z = sqrt(likelihood ratio) > c = sqrt(threshold). With r(theta) the signed root of the rise
// of -2 ln L, standard normal under theta, z = r + (z - r), so that given the selection
//   P(more than what was found | theta) = P(N > r) / P(N > r + c - z),
// and the lower limit is where that is 2.5 %: always at r > 1.96, at infinity for z -> c, at 1.96 for z >> c. Source:
// Zhong and Prentice (2008), Bias-reduced estimators and confidence intervals for odds ratios in genome-wide
// association studies, Biostatistics 9:621; Weinstein, Fithian and Benjamini (2013), Selection adjusted confidence
// intervals, JASA 108:165. The upper limit stays that of the plain interval, which is the larger one.

namespace {

constexpr double kFewestSquares = 0.5;  ///< degrees of freedom
constexpr double kSymmetric = 1e-2;     ///< skewness below which the chi-square of one degree of freedom is right
constexpr double kFarRoot = 20;         ///< beyond it a limit is zero whatever the term

double above(double r) { return 0.5 * std::erfc(r / std::numbers::sqrt2); }

}  // namespace

double rise_below(double tail, double skewness) {
  if (!(skewness > kSymmetric)) return chi_square_upper_quantile(2 * tail, 1);
  const double dof = std::max(kFewestSquares, 8 / (skewness * skewness)), q = chi_square_quantile(tail, dof) / dof;
  return dof * (q - 1 - std::log(q));
}

double selected_rise(double likelihood_ratio, double threshold) {
  const double z = std::sqrt(likelihood_ratio), c = std::sqrt(threshold);
  if (!(z - c < kFarRoot)) return kTwoSided95;
  double low = std::sqrt(kTwoSided95), high = kFarRoot;
  for (int i = 0; i < 60; ++i) {
    const double r = 0.5 * (low + high);
    (above(r) > kEachTail * above(r + c - z) ? low : high) = r;
  }
  return high * high;
}

namespace {

class Profile {
 public:
  Profile(const BinProblem& problem, const TermSet& terms, const Optimum& best, std::size_t term)
      : problem_(problem), others_(terms), best_(best), term_(term), warm_(best.at) {
    others_[term] = false;
  }

  /// sqrt of the rise of -2 lnL at theta.
  double root_rise(double theta) {
    ModelPoint start = warm_;
    start.theta[term_] = theta;
    double value = 0;
    if (count_of(others_) == 0 && problem_.shapes() == 0) {
      value = half_deviance(problem_, start);
    } else {
      const ScoringResult result = score(problem_, others_, &start, 1e-7);
      value = result.half_deviance;
      if (std::isfinite(value)) warm_ = result.at;
    }
    if (!std::isfinite(value)) return 1e6;
    return std::sqrt(std::max(0.0, 2 * (value - best_.half_deviance)));
  }

  /// sqrt of the rise at which less than what was found has the probability `tail` under theta; after root_rise(theta).
  double root_at(double theta, double tail) const {
    ModelPoint at = warm_;
    at.theta[term_] = theta;
    return std::sqrt(rise_below(tail, score_moments(problem_, at, only_positive(at.theta), term_).skewness));
  }

 private:
  const BinProblem& problem_;
  TermSet others_;
  const Optimum& best_;
  std::size_t term_;
  ModelPoint warm_;
};

/// Root of f between x_in (f < 0) and x_out (f > 0).
template <typename Function>
double bracketed_root(Function&& f, double x_in, double f_in, double x_out, double f_out) {
  for (int i = 0; i < 60; ++i) {
    double x = x_in + (x_out - x_in) * f_in / (f_in - f_out);
    const double margin = 0.02 * (x_out - x_in);
    if (std::abs(x - x_in) < std::abs(margin)) x = x_in + margin;
    if (std::abs(x_out - x) < std::abs(margin)) x = x_out - margin;
    const double value = f(x);
    if (std::abs(value) < 1e-4 || std::abs(x_out - x_in) < 1e-7) return x;
    (value < 0 ? x_in : x_out) = x;
    (value < 0 ? f_in : f_out) = value;
  }
  return 0.5 * (x_in + x_out);
}

/// Root of f behind `in`, where f < 0: steps grow until one reaches beyond it.
template <class F>
double root_beyond(const F& f, double in, double f_in, double step) {
  double out = in + step, f_out = f(out);
  for (int i = 0; i < 60 && f_out < 0; ++i) {
    in = out;
    f_in = f_out;
    step *= 1.5;
    out = in + step;
    f_out = f(out);
  }
  return bracketed_root(f, in, f_in, out, f_out);
}

}  // namespace

double profile_upper(const BinProblem& problem, const TermSet& terms, const Optimum& best, std::size_t term, double sd,
                     double tail, double at_least) {
  Profile profile(problem, terms, best, term);
  const double goal = std::sqrt(rise_below(tail, 0)), at = std::max(best.at.theta[term], at_least);
  const auto f = [&](double theta) {
    const double root = profile.root_rise(theta);
    return root - profile.root_at(theta, tail);
  };
  const double below = at > best.at.theta[term] ? f(at) : -goal;
  return below < 0 ? root_beyond(f, at, below, goal * sd) : at;
}

double profile_lower(const BinProblem& problem, const TermSet& terms, const Optimum& best, std::size_t term, double sd,
                     double rise) {
  Profile profile(problem, terms, best, term);
  const double goal = std::sqrt(rise), at = best.at.theta[term];
  if (!(at > 0)) return 0;
  TermSet others = terms;
  others[term] = false;
  if ((count_of(others) > 0 || problem.shapes() > 0) && profile.root_rise(0) <= goal) return 0;
  const auto f = [&](double log_theta) { return profile.root_rise(std::exp(log_theta)) - goal; };
  return std::exp(root_beyond(f, std::log(at), -goal, -goal * std::min(sd / at, 1.0)));
}

}  // namespace libchar

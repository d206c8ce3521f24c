// Fit of a curve alone: an Allan curve or a spectrum digitised from a data sheet or a paper. What
// is known of its scatter decides the weights and what the intervals mean, and a sentence says so:
//   relative_sd given       weights 1/sd^2, chi-square tells whether they were right;
//   duration of the record  the exact covariance of its overlapping Allan variances (of the fitted
//                           mixture, refined three times), with the mean and the variance that the
//                           logarithm of a chi-square of as many degrees of freedom has;
//   neither                 the scatter about the fit says it: equal relative errors, of a spectrum a power of
//                           the frequency (detail/curve/curve_likelihood.hpp); neighbouring residuals that go
//                           the same way count as fewer points, n (1-r)/(1+r).
// Of a curve of more than 512 points neighbours are put together first, in at most that many groups that are even in
// the logarithm of the abscissa: means of ln x and ln y by their weights, with the weight of all of them. Where stated
// uncertainties (or a record's length) are contradicted by the scatter about the fit, the fast end of the curve is left
// out, point by point, until the terms describe the rest: a sensor's filter shows there, and nearly all of the weight
// is there. Where no half of the points is described, nothing is borne out: status misfit, and the scatter takes the
// place of the uncertainties, in the decisions (differences of chi-square over chi-square a degree of freedom) as in
// the intervals.
#include "libchar/fit/curve/curve_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/coefficient.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/fit/detail/curve/coefficients.hpp"
#include "libchar/fit/detail/curve/curve_likelihood.hpp"
#include "libchar/fit/detail/curve/profile.hpp"
#include "libchar/fit/fit_options.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/spectrum/spectrum.hpp"

namespace libchar {
namespace {

constexpr double kBarelyKnown = 0.30;  ///< relative sd above which a value is undetermined
constexpr double kDescribed =
    0.02;  ///< probability of the residuals from which on they are those of the stated scatter
constexpr double kMisfitCurve = 1e-3;     ///< below which they are not
constexpr std::size_t kMostPoints = 512;  ///< that are fitted one by one
constexpr double kDigitised = 1e-6;       ///< relative scatter below which differences of fit mean nothing

void check(const DigitisedCurve& curve) {
  if (curve.x.size() != curve.y.size())
    throw input_error("E0803").says("the curve has {} abscissae but {} values", curve.x.size(), curve.y.size());
  if (!curve.relative_sd.empty() && curve.relative_sd.size() != curve.x.size())
    throw input_error("E0803").says("the curve needs as many relative standard deviations as points");
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (!(curve.x[i] > 0) || !std::isfinite(curve.x[i]))
      throw input_error("E0803")
          .says("point {} of the curve: the abscissa must be positive", i + 1)
          .got("{}", curve.x[i]);
    if (!(curve.y[i] > 0) || !std::isfinite(curve.y[i]))
      throw input_error("E0803").says("point {} of the curve: the value must be positive", i + 1).got("{}", curve.y[i]);
    if (!curve.relative_sd.empty() && !(curve.relative_sd[i] > 0))
      throw input_error("E0803").says("point {} of the curve: the standard deviation must be positive", i + 1);
    if (i > 0 && !(curve.x[i] > curve.x[i - 1]))
      throw input_error("E0803").says("point {} of the curve: the abscissae must ascend", i + 1).got("{}", curve.x[i]);
  }
  if (curve.rate_hz && !(*curve.rate_hz > 0)) throw input_error("E0803").says("the rate of a curve must be positive");
  if (curve.duration_s && !(*curve.duration_s > 0))
    throw input_error("E0803").says("the duration of a curve's record must be positive");
}

/// Expectation of unit theta at x, in the exact discrete form when the rate is known.
double unit_at(const DigitisedCurve& curve, std::size_t term, double x) {
  const auto which = static_cast<Term>(term);
  if (curve.is_allan) {
    if (!curve.rate_hz) return allan_asymptote(which, x);
    return unit_allan_variance(which, std::max(1.0, x * *curve.rate_hz), 1 / *curve.rate_hz);
  }
  if (!curve.rate_hz) return spectrum_asymptote(which, x, 1);
  return unit_spectrum(which, std::min(x, 0.5 * *curve.rate_hz), 1 / *curve.rate_hz);
}

CurveProblem problem_of(const DigitisedCurve& curve) {
  CurveProblem problem;
  const auto n = static_cast<Eigen::Index>(curve.x.size());
  problem.value.resize(n);
  problem.unit.resize(n, static_cast<int>(kTerms));
  const double sides = !curve.is_allan && curve.sides == Sides::one ? 0.5 : 1;
  for (Eigen::Index j = 0; j < n; ++j) {
    const auto at = static_cast<std::size_t>(j);
    problem.value[j] = sides * (curve.root ? curve.y[at] * curve.y[at] : curve.y[at]);
    for (std::size_t i = 0; i < kTerms; ++i)
      problem.unit(j, static_cast<Eigen::Index>(i)) = unit_at(curve, i, curve.x[at]);
  }
  return problem;
}

/// All five terms show in an Allan curve; a spectrum shows no ramp, and quantization only when the rate is known.
TermSet offered_to(const DigitisedCurve& curve, const FitOptions& options) {
  TermSet terms = options.terms;
  terms[static_cast<std::size_t>(Term::quantization)] = curve.is_allan || curve.rate_hz.has_value();
  terms[static_cast<std::size_t>(Term::ramp)] = curve.is_allan;
  return terms;
}

enum class Scatter { stated, from_duration, estimated };

/// What turns a difference of sums of squares into 2 ln L.
struct Judge {
  Scatter scatter = Scatter::estimated;
  double points = 0;       ///< points of the curve
  double independent = 0;  ///< fewer when neighbouring residuals go together
  double floor = 0;        ///< of the sum of squares
  double scale = 1;        ///< variance of the whitened residuals, where it is known to be above one
  double ratio(double without, double with) const {
    if (scatter != Scatter::estimated) return (without - with) / scale;
    return points * std::log((without + floor) / (with + floor));
  }
};

double effective_points(const Eigen::ArrayXd& residual, std::size_t terms) {
  const auto n = static_cast<double>(residual.size());
  const double power = residual.square().sum();
  double lag_one = 0;
  for (Eigen::Index j = 1; j < residual.size(); ++j) lag_one += residual[j] * residual[j - 1];
  const double r = power > 0 ? std::clamp(lag_one / power, 0.0, 0.95) : 0;
  return std::max(n * (1 - r) / (1 + r), std::min(n, static_cast<double>(terms) + 2));
}

struct CurveDecision {
  TermSet kept{};
  CurveSolution best;
  Mixture ratio{};
};

CurveDecision decide(const CurveProblem& problem, const TermSet& offered, double threshold, const Judge& judge) {
  CurveDecision decision{offered, solve_curve_thoroughly(problem, offered), {}};
  const auto without = [&](std::size_t i) {
    TermSet less = decision.kept;
    less[i] = false;
    return solve_curve_thoroughly(problem, less);
  };
  while (count_of(decision.kept) > 1) {
    std::size_t weakest = kTerms;
    double least = threshold;
    CurveSolution replacement;
    for (std::size_t i = 0; i < kTerms; ++i) {
      if (!decision.kept[i]) continue;
      const CurveSolution less = without(i);
      decision.ratio[i] = judge.ratio(less.sum_of_squares, decision.best.sum_of_squares);
      if (decision.ratio[i] >= least && !(decision.best.theta[i] <= 0)) continue;
      if (weakest != kTerms && decision.ratio[i] >= least) continue;
      least = decision.ratio[i];
      weakest = i;
      replacement = less;
    }
    if (weakest == kTerms) break;
    decision.kept[weakest] = false;
    decision.best = replacement;
  }
  return decision;
}

/// Largest theta of a dropped term that the points allow (one-sided 95 %).
double upper_limit(const CurveProblem& problem, const CurveDecision& decision, std::size_t term, const Judge& judge,
                   double rise = kOneSided95) {
  const double level = (problem.value / problem.unit.col(static_cast<Eigen::Index>(term))).minCoeff();
  const auto excess = [&](double theta) {
    Mixture start = decision.best.theta;
    start[term] = theta;
    return judge.ratio(solve_curve(problem, decision.kept, &start).sum_of_squares, decision.best.sum_of_squares) - rise;
  };
  double low = std::max(level * 1e-12, decision.best.theta[term]), high = std::max(level, 2 * low);
  for (int i = 0; i < 40 && excess(high) < 0; ++i) high *= 4;
  for (int i = 0; i < 60 && high / low > 1.001; ++i) {
    const double middle = std::sqrt(low * high);
    (excess(middle) < 0 ? low : high) = middle;
  }
  return std::sqrt(high);
}

void say_what_intervals_mean(const Judge& judge, const std::string& basis, NoiseFit& fit) {
  switch (judge.scatter) {
    case Scatter::stated:
      fit.findings.push_back(finding(
          "curve_uncertainty", "The intervals rest on the stated uncertainty of the points, taken as independent."));
      return;
    case Scatter::from_duration:
      fit.findings.push_back(finding(
          "curve_uncertainty",
          "The intervals rest on the stated record length: the exact covariance of overlapping Allan variances."));
      return;
    case Scatter::estimated:
      fit.findings.push_back(
          finding("curve_uncertainty",
                  "The curve states no uncertainty: the intervals rest on the scatter of its points about the fit, " +
                      basis + "."));
      return;
  }
}

/// The solution with what its scatter makes of it.
struct CurveJudgement {
  const CurveProblem& problem;
  const CurveDecision& decision;
  const Judge& judge;
  TermSet positive{};
  double free_points = 1;
  double mean_square = 0;  ///< of the whitened residuals, as they are
  double scale = 1;        ///< the variance of the whitened residuals that the intervals rest on
  double quantile = 0;     ///< of a two-sided 95 % interval, in standard deviations
  TermMatrix covariance = TermMatrix::Zero();
};

CurveJudgement judged(const CurveProblem& problem, const CurveDecision& decision, const Judge& judge) {
  CurveJudgement out{problem, decision, judge};
  const CurveSolution& best = decision.best;
  out.positive = only_positive(best.theta);
  out.free_points = std::max(1.0, judge.independent - static_cast<double>(count_of(out.positive)));
  out.mean_square = best.sum_of_squares / out.free_points;
  const bool estimated = judge.scatter == Scatter::estimated;
  out.scale = estimated ? out.mean_square : std::max(1.0, out.mean_square);
  out.quantile = estimated ? student_quantile(0.975, out.free_points) : kNormal95;
  out.covariance = inverse_of(curve_information(problem, best.theta, out.positive), out.positive) * out.scale;
  return out;
}

/// Where twice the log-likelihood has fallen by its 95 % point; 0 when it has not at zero.
Interval profiled(const CurveJudgement& found, std::size_t term) {
  const CurveDecision& decision = found.decision;
  TermSet others = decision.kept;
  others[term] = false;
  const auto excess = [&](double theta) {
    Mixture start = decision.best.theta;
    start[term] = theta;
    return found.judge.ratio(solve_curve(found.problem, others, &start).sum_of_squares, decision.best.sum_of_squares) -
           kTwoSided95;
  };
  CurveDecision without = decision;
  without.kept = others;
  const double high = upper_limit(found.problem, without, term, found.judge, kTwoSided95);
  double low = decision.best.theta[term] * 1e-6, at = decision.best.theta[term];
  if (!(excess(low) > 0)) return {0, high};
  for (int i = 0; i < 60 && at / low > 1.001; ++i) {
    const double middle = std::sqrt(low * at);
    (excess(middle) > 0 ? low : at) = middle;
  }
  return {std::sqrt(at), high};
}

void report_positive_term(const CurveJudgement& found, std::size_t i, double threshold, NoiseFit& fit) {
  const Judge& judge = found.judge;
  const Mixture& theta = found.decision.best.theta;
  Coefficient& term = fit.term[i];
  const auto c = static_cast<Eigen::Index>(i);
  // Points that go together are fewer than they look: a term that needs all of them is not established.
  const bool established = found.decision.ratio[i] * judge.independent / judge.points > threshold;
  term.status = established ? Status::detected : Status::undetermined;
  term.value = std::sqrt(theta[i]);
  term.relative_sd = std::sqrt(found.covariance(c, c)) / (2 * theta[i]);
  const double spread = std::exp(found.quantile * term.relative_sd);
  term.ci95 = {*term.value / spread, *term.value * spread};
  if (term.relative_sd > kBarelyKnown) {
    if (term.status == Status::detected) term.status = Status::undetermined;
    term.profile = true;
    term.ci95 = profiled(found, i);
  }
  for (std::size_t j = 0; j < kTerms; ++j)
    if (found.positive[j])
      fit.covariance[i][j] = found.covariance(c, static_cast<Eigen::Index>(j)) / (theta[i] * theta[j]);
}

void report_terms(const CurveJudgement& found, const TermSet& offered, double threshold, NoiseFit& fit) {
  const CurveSolution& best = found.decision.best;
  fit.theta = best.theta;
  fit.search.converged = best.converged;
  fit.search.iterations = best.iterations;
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (!offered[i]) continue;
    Coefficient& term = fit.term[i];
    term.likelihood_ratio = found.decision.ratio[i];
    if (found.positive[i]) {
      report_positive_term(found, i, threshold, fit);
    } else {
      term.status = Status::not_detected;
      term.upper95 = upper_limit(found.problem, found.decision, i, found.judge);
    }
  }
}

void report_goodness(const CurveJudgement& found, const std::string& basis, NoiseFit& fit) {
  const bool estimated = found.judge.scatter == Scatter::estimated;
  const double sum = found.decision.best.sum_of_squares;
  fit.goodness.chi2 = estimated ? found.free_points : sum;
  fit.goodness.dof = found.free_points;
  fit.goodness.p = estimated ? 1 : chi_square_tail(sum, found.free_points);
  say_what_intervals_mean(found.judge, basis, fit);
  if (!estimated && fit.goodness.p < 1e-3) {
    fit.findings.push_back(
        finding("curve_scatter", fmt::format("The points scatter {} times more about the model than their uncertainty "
                                             "says; the intervals are widened by that.",
                                             brief_text(std::sqrt(found.scale), 2))));
  }
}

void report_residuals(const DigitisedCurve& curve, const CurveJudgement& found, NoiseFit& fit) {
  const CurveProblem& problem = found.problem;
  const Mixture& theta = found.decision.best.theta;
  const Eigen::ArrayXd z =
      curve_residuals(problem, theta) / std::sqrt(std::max(found.scale, std::numeric_limits<double>::min()));
  for (Eigen::Index j = 0; j < problem.size(); ++j) {
    double model = 0;
    for (std::size_t i = 0; i < kTerms; ++i)
      model += theta[i] > 0 ? theta[i] * problem.unit(j, static_cast<Eigen::Index>(i)) : 0;
    const double measured = problem.value[j];
    const bool allan = curve.is_allan;
    fit.residuals.push_back({curve.x[static_cast<std::size_t>(j)], allan ? std::sqrt(measured) : measured,
                             allan ? std::sqrt(model) : model, 0, z[j]});
  }
}

Eigen::Map<const Eigen::ArrayXd> array_of(const std::vector<double>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

double points_of(const DigitisedCurve& curve) { return std::accumulate(curve.group.begin(), curve.group.end(), 0.0); }

NoiseFit fit_points(const DigitisedCurve& curve, const TermSet& offered, const FitOptions& options, double scale) {
  if (curve.x.size() < count_of(offered)) {
    throw numeric_error("E0401")
        .says("{} points of the curve are fewer than the {} noise terms to fit", curve.x.size(), count_of(offered))
        .hint("digitise more points");
  }
  CurveProblem problem = problem_of(curve);
  Judge judge;
  judge.points = judge.independent = static_cast<double>(curve.x.size());
  judge.scale = scale;
  CurveSolution rough;
  std::string basis;  // of a scatter that is estimated
  if (!curve.relative_sd.empty()) {
    judge.scatter = Scatter::stated;
    problem.weight = (2 * array_of(curve.relative_sd)).inverse();
  } else if (curve.duration_s && curve.is_allan) {
    judge.scatter = Scatter::from_duration;
    rough = weigh_by_duration(curve, *curve.duration_s, kReading, offered, problem);
  } else {
    basis = curve.is_allan ? weigh_evenly(curve, offered, problem) : weigh_by_frequency(curve, offered, problem);
    rough = solve_curve_thoroughly(problem, offered);
    judge.independent = effective_points(curve_residuals(problem, rough.theta), count_of(offered));
    judge.floor = judge.points * kDigitised * kDigitised;
  }
  const CurveDecision decision = decide(problem, offered, options.threshold, judge);
  NoiseFit fit;
  fit.rate_hz = curve.rate_hz.value_or(0);
  fit.duration_s = curve.duration_s.value_or(0);
  fit.samples = curve.x.size();
  fit.search.method = fmt::format(
      "non-negative least squares on the logarithm of {} {}, {}", curve.x.size(),
      curve.group.empty() ? "points" : fmt::format("groups of neighbours among {:.0f} points", points_of(curve)),
      curve.rate_hz ? "exact discrete curves" : "continuous asymptotes (the rate is not known)");
  const CurveJudgement found = judged(problem, decision, judge);
  report_terms(found, offered, options.threshold, fit);
  report_goodness(found, basis, fit);
  report_residuals(curve, found, fit);
  return fit;
}

/// The curve without `left_out` points of its fast end.
DigitisedCurve slow_part(const DigitisedCurve& curve, std::size_t left_out) {
  DigitisedCurve part = curve;
  const auto cut = [&](std::vector<double>& values) {
    if (values.empty()) return;
    const auto count = static_cast<std::ptrdiff_t>(left_out);
    if (curve.is_allan)
      values.erase(values.begin(), values.begin() + count);
    else
      values.erase(values.end() - count, values.end());
  };
  cut(part.x);
  cut(part.y);
  cut(part.relative_sd);
  cut(part.group);
  return part;
}

/// What was left out stays in the residuals, outside the band.
void report_left_out(const DigitisedCurve& curve, std::size_t left_out, NoiseFit& fit) {
  const double edge = curve.is_allan ? curve.x[left_out] : curve.x[curve.x.size() - left_out - 1];
  const CurveProblem problem = problem_of(curve);
  std::vector<FitResidual> outside;
  for (std::size_t k = 0; k < left_out; ++k) {
    const std::size_t at = curve.is_allan ? k : curve.x.size() - left_out + k;
    const auto j = static_cast<Eigen::Index>(at);
    double model = 0;
    for (std::size_t i = 0; i < kTerms; ++i)
      model += fit.theta[i] > 0 ? fit.theta[i] * problem.unit(j, static_cast<Eigen::Index>(i)) : 0;
    const double measured = problem.value[j];
    outside.push_back({curve.x[at], curve.is_allan ? std::sqrt(measured) : measured,
                       curve.is_allan ? std::sqrt(model) : model, 0, 0, false});
  }
  fit.residuals.insert(curve.is_allan ? fit.residuals.begin() : fit.residuals.end(), outside.begin(), outside.end());
  fit.band.whole = false;
  fit.band.top_hz = curve.is_allan ? 1 / (2 * edge) : edge;
  fit.remedies.push_back({"band", "the noise terms do not describe the whole curve within its uncertainty",
                          curve.is_allan
                              ? fmt::format("coefficients from averaging times of {} on, {} of {} points left out",
                                            duration_text(edge), left_out, curve.x.size())
                              : fmt::format("coefficients from below {}, {} of {} points left out",
                                            detail::frequency_text(edge, 4), left_out, curve.x.size()),
                          left_out});
}

/// Does the fit still say something of each of the three terms that the other says something of?
bool says_as_much(const NoiseFit& fit, const NoiseFit& other) {
  for (const Term t : {Term::white, Term::flicker, Term::walk})
    if (other[t].value && !fit[t].value) return false;
  return true;
}

/// Points of the fast end that stand within an octave, after those left out.
std::size_t points_in_octave(const DigitisedCurve& curve, std::size_t left_out) {
  const std::size_t n = curve.x.size();
  std::size_t count = 0;
  while (left_out + count < n) {
    const double first = curve.is_allan ? curve.x[left_out] : curve.x[n - 1 - left_out];
    const double at = curve.is_allan ? curve.x[left_out + count] : curve.x[n - 1 - left_out - count];
    if (std::max(first / at, at / first) > 1.9) break;
    ++count;
  }
  return count;
}

/// Neighbours together, the slow end (few of the points, much of the information) as it is. Of a
/// spectrum that states no uncertainty powers are averaged: the mean of their logarithms is low.
DigitisedCurve grouped(const DigitisedCurve& curve) {
  DigitisedCurve out = curve;
  for (auto* values : {&out.x, &out.y, &out.relative_sd}) values->clear();
  const double width = std::log(curve.x.back() / curve.x.front()) / static_cast<double>(kMostPoints - 1);
  const bool of_powers = !curve.is_allan && curve.relative_sd.empty();
  const double power = curve.root ? 2 : 1;
  for (std::size_t from = 0, to = 0; from < curve.x.size(); from = to) {
    double weight = 0, x = 0, y = 0;
    for (; to < curve.x.size() && std::log(curve.x[to] / curve.x[from]) < width; ++to) {
      const double sd = curve.relative_sd.empty() ? 1 : curve.relative_sd[to], w = 1 / (sd * sd);
      weight += w;
      x += w * std::log(curve.x[to] / curve.x[from]);
      const double ratio = curve.y[to] / curve.y[from];
      y += w * (of_powers ? std::pow(ratio, power) : std::log(ratio));
    }
    out.x.push_back(curve.x[from] * std::exp(x / weight));
    out.y.push_back(curve.y[from] * (of_powers ? std::pow(y / weight, 1 / power) : std::exp(y / weight)));
    if (!curve.relative_sd.empty()) out.relative_sd.push_back(1 / std::sqrt(weight));
    out.group.push_back(static_cast<double>(to - from));
  }
  return out;
}

/// Half of the points at least, and more than there are terms.
std::size_t fewest_points(std::size_t points, const TermSet& offered) {
  return std::max((points + 1) / 2, count_of(offered) + 3);
}

/// The same curve in another unit, `scale` of them one of the channel's: a power of two, which leaves the digits.
DigitisedCurve in_unit(DigitisedCurve curve, double scale) {
  for (double& y : curve.y) y *= curve.root ? scale : scale * scale;
  return curve;
}

/// Back from it.
void take_unit_back(double scale, bool is_allan, NoiseFit& fit) {
  for (Coefficient& term : fit.term) {
    if (term.value) *term.value /= scale;
    if (term.upper95) *term.upper95 /= scale;
    term.ci95 = {term.ci95.low / scale, term.ci95.high / scale};
  }
  for (double& theta : fit.theta) theta = theta / scale / scale;
  for (FitResidual& residual : fit.residuals)
    for (double* value : {&residual.measured, &residual.model})
      *value = is_allan ? *value / scale : *value / scale / scale;
}

NoiseFit fit_in_range(const DigitisedCurve& curve, const FitOptions& options) {
  if (curve.x.size() > kMostPoints && curve.group.empty()) return fit_in_range(grouped(curve), options);
  const TermSet offered = offered_to(curve, options);
  NoiseFit whole = fit_points(curve, offered, options, 1);
  // A scatter that is estimated from the points themselves contradicts nothing. Without the rate, the record's length
  // alone does not give the covariance of a part of its curve.
  const bool judged = !curve.relative_sd.empty() || (curve.duration_s && curve.is_allan);
  const bool divisible = !curve.relative_sd.empty() || curve.rate_hz;
  if (!judged || whole.goodness.p >= kDescribed) return whole;
  const std::size_t points = curve.x.size(), fewest = fewest_points(points, offered);
  for (std::size_t left_out = 1; divisible && points - left_out >= fewest && left_out < points; ++left_out) {
    NoiseFit part = fit_points(slow_part(curve, left_out), offered, options, 1);
    // White noise is seen at the fast end: a part that says nothing of it any more has left out more than a filter.
    if (part.goodness.p < kDescribed || (whole[Term::white].value && !part[Term::white].value)) continue;
    // An octave more takes out the bias that "just passes" leaves.
    const std::size_t further = left_out + points_in_octave(curve, left_out);
    if (points - std::min(further, points) >= fewest) {
      NoiseFit safer = fit_points(slow_part(curve, further), offered, options, 1);
      if (safer.goodness.p >= kDescribed && says_as_much(safer, part)) {
        part = std::move(safer);
        left_out = further;
      }
    }
    report_left_out(curve, left_out, part);
    return part;
  }
  if (whole.goodness.p >= kMisfitCurve) return whole;
  NoiseFit misfit = fit_points(curve, offered, options, whole.goodness.chi2 / std::max(1.0, whole.goodness.dof));
  for (Coefficient& term : misfit.term)
    if (term.value) term.status = Status::misfit;
  misfit.findings.push_back(finding("misfit",
                                    "The noise terms do not describe this curve, nor half of its points, within its "
                                    "uncertainty: the data support no coefficient.",
                                    "the noise terms do not describe the curve"));
  return misfit;
}

}  // namespace

NoiseFit fit_curve(const DigitisedCurve& curve, const FitOptions& options) {
  check(curve);
  const int octave = curve.y.empty() ? 0 : std::ilogb(curve.y.front());
  const double scale = std::exp2(curve.root ? -octave : -octave / 2);
  NoiseFit fit = fit_in_range(in_unit(curve, scale), options);
  take_unit_back(scale, curve.is_allan, fit);
  return fit;
}

}  // namespace libchar

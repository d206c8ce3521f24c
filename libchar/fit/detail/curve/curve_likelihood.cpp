// Gauss-Newton on r = W (ln v - ln A theta), theta >= 0. d ln mu / d theta_i = A_i / mu, so that
// each step is the linear problem
//   min || W diag(1/mu) (t - A theta) ||,  t = mu (1 + ln(v/mu)),
// solved exactly over theta >= 0; the step is halved while the sum of squares does not fall.

#include "libchar/fit/detail/curve/curve_likelihood.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fit/detail/curve/nonnegative.hpp"

namespace libchar {
namespace {

Eigen::ArrayXd model_of(const CurveProblem& problem, const Mixture& theta) {
  Eigen::ArrayXd model = Eigen::ArrayXd::Zero(problem.size());
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (theta[i] > 0) model += theta[i] * problem.unit.col(static_cast<Eigen::Index>(i));
  }
  return model;
}

/// ln v - ln mu, of which the expectation is zero.
Eigen::ArrayXd log_ratio(const CurveProblem& problem, const Eigen::ArrayXd& model) {
  Eigen::ArrayXd ratio = (problem.value / model).log();
  if (problem.bias.size() > 0) ratio -= problem.bias;
  return ratio;
}

Eigen::MatrixXd whitened(const CurveProblem& problem, const Eigen::MatrixXd& columns) {
  if (problem.weight.size() > 0) return problem.weight.matrix().asDiagonal() * columns;
  return problem.whitening.size() == 0 ? columns : Eigen::MatrixXd(problem.whitening * columns);
}

/// Columns A_i/mu of the free terms (others zero), whitened.
Eigen::MatrixXd jacobian(const CurveProblem& problem, const Eigen::ArrayXd& model, const TermSet& free) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(problem.size(), static_cast<int>(kTerms));
  for (std::size_t i = 0; i < kTerms; ++i) {
    const auto c = static_cast<Eigen::Index>(i);
    if (free[i]) columns.col(c) = problem.unit.col(c) / model;
  }
  return whitened(problem, columns);
}

double sum_of_squares(const CurveProblem& problem, const Mixture& theta) {
  const double sum = curve_residuals(problem, theta).square().sum();
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

Mixture step_goal(const CurveProblem& problem, const TermSet& free, const Mixture& fixed, const Eigen::ArrayXd& model) {
  const Eigen::MatrixXd columns = jacobian(problem, model, free);
  const Eigen::ArrayXd held = model_of(problem, fixed);
  const Eigen::MatrixXd target = whitened(problem, ((1 + log_ratio(problem, model)) - held / model).matrix());
  const TermMatrix gram = columns.transpose() * columns;
  const Eigen::VectorXd product = columns.transpose() * target;
  Mixture right{};
  for (std::size_t i = 0; i < kTerms; ++i) right[i] = product[static_cast<Eigen::Index>(i)];
  Mixture goal = nonnegative_minimum(gram, right, free);
  for (std::size_t i = 0; i < kTerms; ++i) goal[i] = free[i] ? goal[i] : fixed[i];
  return goal;
}

/// The sum of squares is flat to rounding within 1e-8 of the minimum; the step itself goes on to
/// shrink. Follows it while it does.
void refine(const CurveProblem& problem, const TermSet& free, const Mixture& fixed, CurveSolution& solution) {
  double before = 1e-4;
  for (int i = 0; i < 60; ++i) {
    const Mixture goal = step_goal(problem, free, fixed, model_of(problem, solution.theta));
    double moved = 0;
    for (std::size_t t = 0; t < kTerms; ++t) {
      if (goal[t] != solution.theta[t]) moved = std::max(moved, std::abs(goal[t] / solution.theta[t] - 1));
    }
    if (!(moved < before)) return;
    before = moved;
    solution.theta = goal;
  }
}

}  // namespace

Eigen::ArrayXd curve_residuals(const CurveProblem& problem, const Mixture& theta) {
  return whitened(problem, log_ratio(problem, model_of(problem, theta)).matrix()).array();
}

TermMatrix curve_information(const CurveProblem& problem, const Mixture& theta, const TermSet& terms) {
  const Eigen::MatrixXd columns = jacobian(problem, model_of(problem, theta), terms);
  return columns.transpose() * columns;
}

CurveSolution solve_curve(const CurveProblem& problem, const TermSet& free, const Mixture* start) {
  Mixture fixed{};
  for (std::size_t i = 0; i < kTerms; ++i) fixed[i] = start != nullptr && !free[i] ? (*start)[i] : 0;
  CurveSolution solution;
  // Linear weights 1/v^2 to begin with: mu = v makes ln(v/mu) vanish.
  solution.theta = start != nullptr ? *start : step_goal(problem, free, fixed, problem.value);
  solution.sum_of_squares = sum_of_squares(problem, solution.theta);
  if (!std::isfinite(solution.sum_of_squares)) {
    solution.theta = step_goal(problem, free, fixed, problem.value);
    solution.sum_of_squares = sum_of_squares(problem, solution.theta);
  }
  for (; solution.iterations < 300 && std::isfinite(solution.sum_of_squares); ++solution.iterations) {
    const Mixture goal = step_goal(problem, free, fixed, model_of(problem, solution.theta));
    double share = 1, value = 0;
    Mixture next{};
    for (;; share /= 2) {
      for (std::size_t i = 0; i < kTerms; ++i) next[i] = solution.theta[i] + share * (goal[i] - solution.theta[i]);
      value = sum_of_squares(problem, next);
      if (value <= solution.sum_of_squares || share < 1e-8) break;
    }
    const double gain = solution.sum_of_squares - value;
    if (gain > 0) {
      solution.theta = next;
      solution.sum_of_squares = value;
    }
    if (!(gain > 1e-13 * solution.sum_of_squares)) {
      solution.converged = true;
      break;
    }
  }
  if (solution.converged) refine(problem, free, fixed, solution);
  return solution;
}

CurveSolution solve_curve_thoroughly(const CurveProblem& problem, const TermSet& free) {
  CurveSolution best;
  best.sum_of_squares = std::numeric_limits<double>::infinity();
  for (unsigned set = 1; set < (1U << kTerms); ++set) {
    TermSet part{};
    bool inside = true;
    for (std::size_t i = 0; i < kTerms; ++i) {
      part[i] = (set >> i & 1U) != 0;
      inside = inside && (!part[i] || free[i]);
    }
    if (!inside) continue;
    CurveSolution found = solve_curve(problem, part);
    if (std::isfinite(found.sum_of_squares) && part != free) found = solve_curve(problem, free, &found.theta);
    if (found.sum_of_squares < best.sum_of_squares) best = found;
  }
  return best;
}

namespace {

/// The smallest multiple of the first point's that makes every averaging time a whole number of samples, to 2 %.
double likely_rate(const DigitisedCurve& curve) {
  double rate_hz = 1 / curve.x.front();
  const auto whole = [&] {
    return std::all_of(curve.x.begin(), curve.x.end(), [&](double tau_s) {
      const double m = tau_s * rate_hz;
      return std::abs(std::round(m) / m - 1) < 0.02;
    });
  };
  for (int i = 0; i < 6 && !whole(); ++i) rate_hz *= 2;
  return rate_hz;
}

/// What a record of some length makes of ln(variance): bias, and inverse Cholesky factor of the covariance. A variance
/// with few degrees of freedom, as at the slow end, is that of a chi-square, whose logarithm is skew.
class RecordScatter {
 public:
  RecordScatter(const DigitisedCurve& curve, double duration_s)
      : record_(record_of(curve, duration_s)), covariance_(record_) {}

  void weigh(const Mixture& theta, double reading, CurveProblem& problem) const {
    Mixture noise = theta;
    noise[static_cast<std::size_t>(Term::ramp)] = 0;  // not random
    Eigen::MatrixXd covariance = covariance_.at(noise);
    const auto n = covariance.rows();
    Eigen::VectorXd level(n), wider(n);
    for (Eigen::Index j = 0; j < n; ++j)
      level[j] =
          allan_variance(noise, static_cast<double>(record_.points[static_cast<std::size_t>(j)].m), record_.dt_s);
    covariance = level.cwiseInverse().asDiagonal() * covariance * level.cwiseInverse().asDiagonal();
    problem.bias.resize(n);
    for (Eigen::Index j = 0; j < n; ++j) {
      const LogMoments moments = chi_square_log_moments(2 / covariance(j, j));
      problem.bias[j] = moments.mean;
      wider[j] = std::sqrt(moments.variance / covariance(j, j));
    }
    covariance = wider.asDiagonal() * covariance * wider.asDiagonal();
    // Neighbours a fraction of an octave apart would be singular without reading errors.
    covariance.diagonal().array() += reading * reading + 0.01 * covariance.diagonal().array();
    problem.whitening = inverse_cholesky_factor(covariance);
  }

 private:
  static AllanCurve record_of(const DigitisedCurve& curve, double duration_s) {
    const double rate_hz = curve.rate_hz.value_or(likely_rate(curve));
    AllanCurve record;
    record.dt_s = 1 / rate_hz;
    record.samples = clamped_whole<std::uint64_t>(std::round(duration_s * rate_hz));
    for (const double tau_s : curve.x) {
      AllanPoint point;
      point.m = std::max<std::uint64_t>(1, clamped_whole<std::uint64_t>(std::round(tau_s * rate_hz)));
      point.m = std::min(point.m, record.samples / 2);
      point.tau_s = static_cast<double>(point.m) / rate_hz;
      point.terms = record.samples - 2 * point.m + 1;
      record.points.push_back(point);
    }
    return record;
  }
  AllanCurve record_;
  AllanCovariance covariance_;
};

CurveSolution solve_weighed(const RecordScatter& scatter, double reading, const TermSet& offered, int rounds,
                            CurveSolution best, CurveProblem& problem) {
  for (int round = 0; round < rounds; ++round) {
    scatter.weigh(best.theta, reading, problem);
    best = solve_curve_thoroughly(problem, offered);
  }
  return best;
}

Eigen::ArrayXd weights_of_groups(const DigitisedCurve& curve) {
  return Eigen::Map<const Eigen::ArrayXd>(curve.group.data(), static_cast<Eigen::Index>(curve.group.size())).sqrt();
}

/// Degrees of freedom of a chi-square whose logarithm has this variance.
double dof_of_log_variance(double variance) {
  double low = 1, high = 1e12;
  while (high / low > 1.0001) {
    const double middle = std::sqrt(low * high);
    (chi_square_log_moments(middle).variance > variance ? low : high) = middle;
  }
  return low;
}

}  // namespace

CurveSolution weigh_by_duration(const DigitisedCurve& curve, double duration_s, double reading, const TermSet& offered,
                                CurveProblem& problem) {
  return solve_weighed(RecordScatter(curve, duration_s), reading, offered, 3, solve_curve_thoroughly(problem, offered),
                       problem);
}

std::string weigh_evenly(const DigitisedCurve& curve, const TermSet& offered, CurveProblem& problem) {
  if (!curve.group.empty()) problem.weight = weights_of_groups(curve);
  const double sum = solve_curve_thoroughly(problem, offered).sum_of_squares;
  return fmt::format(
      "taken as {} of the ordinate at every point: they say how well the drawn curve fixes the coefficients, not how "
      "well the record behind it did; `duration_s` states the length of the record where it is known",
      percent_text(std::sqrt(sum / static_cast<double>(problem.size())) / 2));
}

std::string weigh_by_frequency(const DigitisedCurve& curve, const TermSet& offered, CurveProblem& problem) {
  const auto n = problem.size();
  const Eigen::ArrayXd together = curve.group.empty() ? Eigen::ArrayXd::Ones(n) : weights_of_groups(curve);
  Eigen::ArrayXd below(n);  // the highest frequency, ln
  for (Eigen::Index j = 0; j < n; ++j) below[j] = std::log(curve.x[static_cast<std::size_t>(j)] / curve.x.back());
  const double free = static_cast<double>(n) - std::min(3.0, static_cast<double>(n) / 2);
  const CurveProblem plain = problem;
  double most = -std::numeric_limits<double>::infinity(), highest_dof = 0, power = 0;
  for (const double slope : {0.0, 0.5, 1.0, 1.5}) {
    CurveProblem weighed = plain;
    weighed.weight = together * (0.5 * slope * below).exp();
    double square = 0;
    for (int round = 0; round < 3; ++round) {
      square = solve_curve_thoroughly(weighed, offered).sum_of_squares / free;
      weighed.bias.resize(n);
      for (Eigen::Index j = 0; j < n; ++j)
        weighed.bias[j] = chi_square_log_moments(dof_of_log_variance(square / std::pow(weighed.weight[j], 2))).mean;
    }
    const double log_likelihood = 2 * weighed.weight.log().sum() - static_cast<double>(n) * std::log(square);
    if (!(log_likelihood > most)) continue;
    most = log_likelihood;
    problem = weighed;
    highest_dof = dof_of_log_variance(square);
    power = slope;
  }
  return fmt::format(
      "which is that of about {} degrees of freedom a point{}; a column edf states them where they are known",
      brief_text(highest_dof, 2),
      power > 0 ? fmt::format(" at the highest frequency, with its power of {} below", brief_text(power, 2)) : "");
}

}  // namespace libchar

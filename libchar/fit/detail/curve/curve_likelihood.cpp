// Gauss-Newton on r = W (ln v - ln A theta), theta >= 0. d ln mu / d theta_i = A_i / mu, so that
// each step is the linear problem
//   min || W diag(1/mu) (t - A theta) ||,  t = mu (1 + ln(v/mu)),
// solved exactly over theta >= 0; the step is halved while the sum of squares does not fall.
#include "libchar/fit/detail/curve/curve_likelihood.hpp"

#include <cmath>
#include <limits>

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

}  // namespace libchar

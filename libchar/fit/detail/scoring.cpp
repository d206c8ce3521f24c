// Non-negative Fisher scoring. The likelihood is that of gamma variables whose means are linear in
// theta, so that each scoring step is a weighted linear least-squares problem, theta <-
// argmin_{theta >= 0} sum nu/(2 mu^2) (x - A theta)^2, solved exactly. Start: weights 1/x^2. A step
// that does not lower -ln L is halved. Typically 5-15 steps.
#include "libchar/fit/detail/scoring.hpp"

#include <cmath>
#include <limits>

#include "libchar/core/error.hpp"
#include "libchar/fit/detail/bin_likelihood.hpp"
#include "libchar/fit/detail/nonnegative.hpp"

namespace libchar {
namespace {

Mixture weighted_solution(const BinProblem& problem,
                          const TermSet& free,
                          const Eigen::ArrayXd& weight,
                          const Eigen::ArrayXd& target) {
  TermMatrix gram = TermMatrix::Zero();
  Mixture right{};
  for (std::size_t a = 0; a < kTerms; ++a) {
    if (!free[a]) continue;
    const auto i = static_cast<Eigen::Index>(a);
    const Eigen::ArrayXd weighted = weight * problem.unit.col(i);
    right[a] = (weighted * target).sum();
    for (std::size_t b = 0; b <= a; ++b) {
      const auto j = static_cast<Eigen::Index>(b);
      if (free[b]) gram(i, j) = gram(j, i) = (weighted * problem.unit.col(j)).sum();
    }
  }
  return nonnegative_minimum(gram, right, free);
}

Mixture joined(const Mixture& fixed, const Mixture& solved, const TermSet& free) {
  Mixture theta{};
  for (std::size_t i = 0; i < kTerms; ++i) theta[i] = free[i] ? solved[i] : fixed[i];
  return theta;
}

Mixture between(const Mixture& a, const Mixture& b, double share) {
  Mixture theta{};
  for (std::size_t i = 0; i < kTerms; ++i) theta[i] = a[i] + share * (b[i] - a[i]);
  return theta;
}

}  // namespace

ScoringResult score(const BinProblem& problem,
                    const TermSet& free,
                    const Mixture* start,
                    double tolerance) {
  Mixture fixed{};
  if (start != nullptr) {
    for (std::size_t i = 0; i < kTerms; ++i) fixed[i] = free[i] ? 0 : (*start)[i];
  }
  const Eigen::ArrayXd offset = model_of(problem, fixed);
  const Eigen::ArrayXd target = problem.energy - offset;
  ScoringResult result;
  const auto first_guess = [&] {
    const Eigen::ArrayXd weight = problem.dof / (2 * problem.energy * problem.energy);
    return joined(fixed, weighted_solution(problem, free, weight, target), free);
  };
  result.theta = start != nullptr ? *start : first_guess();
  result.half_deviance = half_deviance(problem, result.theta);
  if (!std::isfinite(result.half_deviance)) {
    // A warm start with a vanishing model: some bin would have no expected power at all.
    result.theta = first_guess();
    result.half_deviance = half_deviance(problem, result.theta);
  }
  if (!std::isfinite(result.half_deviance)) return result;
  for (; result.iterations < 200; ++result.iterations) {
    const Eigen::ArrayXd model = model_of(problem, result.theta);
    const Eigen::ArrayXd weight = problem.dof / (2 * model * model);
    const Mixture goal = joined(fixed, weighted_solution(problem, free, weight, target), free);
    double share = 1;
    Mixture next = goal;
    double value = half_deviance(problem, next);
    while (!(value <= result.half_deviance) && share > 1e-9) {
      share /= 2;
      next = between(result.theta, goal, share);
      value = half_deviance(problem, next);
    }
    if (result.iterations > 8 && share == 1) {
      // Single coefficients bend the likelihood more than their expectation says: full steps may
      // swing about the maximum for long.
      const Mixture middle = between(result.theta, goal, 0.5);
      const double at_middle = half_deviance(problem, middle);
      if (at_middle < value) {
        next = middle;
        value = at_middle;
      }
    }
    const double gain = result.half_deviance - value;
    if (gain > 0) {
      result.theta = next;
      result.half_deviance = value;
    }
    // Rounding of the sum itself is of order 1e-16 times its terms; a gain below that is noise.
    if (!(gain > tolerance + 1e-15 * result.half_deviance)) {
      result.converged = true;
      break;
    }
  }
  return result;
}

}  // namespace libchar

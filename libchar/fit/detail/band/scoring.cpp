// Non-negative Fisher scoring. The likelihood is that of gamma variables whose means are mu = (A theta) exp(S a), so that each
// scoring step is a weighted linear least-squares problem,
//   theta, da <- argmin_{theta >= 0} sum nu/(2 mu^2) (x - exp(S a) A theta - mu S da)^2,
// solved exactly: the shape is eliminated first, then every subset of the terms is tried. Start: weights 1/x^2 and no shape, or
// the slow part of the bins and what the others lack. A step that does not lower -ln L is halved. Typically 5-15 steps.
#include "libchar/fit/detail/band/scoring.hpp"

#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/numeric/dense.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/detail/curve/nonnegative.hpp"

namespace libchar {
namespace {

// The normal equations of a step in the terms alone.
struct TermEquations {
  TermMatrix gram = TermMatrix::Zero();
  Mixture right{};
};

TermEquations equations_of(const BinProblem& problem, const TermSet& free, const Eigen::ArrayXd& weight,
                           const Eigen::ArrayXd& target) {
  TermEquations out;
  for (std::size_t a = 0; a < kTerms; ++a) {
    if (!free[a]) continue;
    const auto i = static_cast<Eigen::Index>(a);
    const Eigen::ArrayXd weighted = weight * problem.unit.col(i);
    out.right[a] = (weighted * target).sum();
    for (std::size_t b = 0; b <= a; ++b) {
      const auto j = static_cast<Eigen::Index>(b);
      if (free[b]) out.gram(i, j) = out.gram(j, i) = (weighted * problem.unit.col(j)).sum();
    }
  }
  return out;
}

Mixture joined(const Mixture& fixed, const Mixture& solved, const TermSet& free) {
  Mixture theta{};
  for (std::size_t i = 0; i < kTerms; ++i) theta[i] = free[i] ? solved[i] : fixed[i];
  return theta;
}

ModelPoint between(const ModelPoint& a, const ModelPoint& b, double share) {
  ModelPoint at;
  for (std::size_t i = 0; i < kTerms; ++i) at.theta[i] = a.theta[i] + share * (b.theta[i] - a.theta[i]);
  for (std::size_t p = 0; p < at.shape.size(); ++p) at.shape[p] = a.shape[p] + share * (b.shape[p] - a.shape[p]);
  return at;
}

// A step with a shape, in units of the model: rows are relative errors with weight nu/2, the shape's columns are taken out of the
// terms' columns (they are orthonormal), and come back when the terms are known.
ModelPoint shaped_step(const BinProblem& problem, const TermSet& free, const Mixture& fixed, const ModelPoint& now) {
  const Eigen::ArrayXd mixture = mixture_of(problem, now.theta);
  const Eigen::ArrayXd gain = shape_of(problem, now.shape);
  const Eigen::ArrayXd root = (problem.dof / 2).sqrt();
  const Eigen::MatrixXd shape = whitened_shape(problem);
  const Eigen::VectorXd target =
      (root * (problem.energy / (gain * mixture) - mixture_of(problem, fixed) / mixture)).matrix();
  Eigen::MatrixXd terms = Eigen::MatrixXd::Zero(problem.size(), static_cast<int>(kTerms));
  for (std::size_t i = 0; i < kTerms; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    if (free[i]) terms.col(column) = (root * problem.unit.col(column) / mixture).matrix();
  }
  const Eigen::MatrixXd apart = without_columns_of(shape, terms);
  const TermMatrix gram = apart.transpose() * apart;
  const Eigen::VectorXd product = apart.transpose() * target;
  Mixture right{};
  for (std::size_t i = 0; i < kTerms; ++i) right[i] = product[static_cast<Eigen::Index>(i)];
  ModelPoint next;
  next.theta = joined(fixed, nonnegative_minimum(gram, right, free), free);
  Eigen::VectorXd rest = target;
  for (std::size_t i = 0; i < kTerms; ++i)
    if (free[i]) rest -= next.theta[i] * terms.col(static_cast<Eigen::Index>(i));
  const Eigen::VectorXd step = shape.transpose() * rest;
  for (Eigen::Index p = 0; p < problem.shapes(); ++p)
    next.shape[static_cast<std::size_t>(p)] = now.shape[static_cast<std::size_t>(p)] + step[p];
  return next;
}

// Where no start is known: the terms from the slow half of the bins, the shape from the logarithm of what is left.
ModelPoint slow_start(const BinProblem& problem, const TermSet& free, const Mixture& fixed) {
  Eigen::ArrayXd weight = problem.dof / (2 * problem.energy * problem.energy);
  weight.tail(problem.size() / 3).setZero();
  const Eigen::ArrayXd offset = mixture_of(problem, fixed);
  const TermEquations equations = equations_of(problem, free, weight, problem.energy - offset);
  ModelPoint at;
  at.theta = joined(fixed, nonnegative_minimum(equations.gram, equations.right, free), free);
  const Eigen::ArrayXd mixture = mixture_of(problem, at.theta);
  if (!(mixture.minCoeff() > 0)) return at;
  const Eigen::ArrayXd root = (problem.dof / 2).sqrt();
  const Eigen::VectorXd log_gain =
      whitened_shape(problem).transpose() * (root * (problem.energy / mixture).log()).matrix();
  for (Eigen::Index p = 0; p < problem.shapes(); ++p) at.shape[static_cast<std::size_t>(p)] = log_gain[p];
  return at;
}

class Scoring {
 public:
  Scoring(const BinProblem& problem, const TermSet& free, const ModelPoint* start) : problem_(problem), free_(free) {
    if (start == nullptr) return;
    for (std::size_t i = 0; i < kTerms; ++i) fixed_[i] = free[i] ? 0 : start->theta[i];
  }

  ModelPoint first_guess() const {
    if (problem_.shapes() > 0) return slow_start(problem_, free_, fixed_);
    const Eigen::ArrayXd weight = problem_.dof / (2 * problem_.energy * problem_.energy);
    return {solved(weight), {}};
  }

  ModelPoint goal(const ModelPoint& now) const {
    if (problem_.shapes() > 0) return shaped_step(problem_, free_, fixed_, now);
    const Eigen::ArrayXd model = mixture_of(problem_, now.theta);
    const Eigen::ArrayXd weight = problem_.dof / (2 * model * model);
    return {solved(weight), {}};
  }

 private:
  Mixture solved(const Eigen::ArrayXd& weight) const {
    const Eigen::ArrayXd target = problem_.energy - mixture_of(problem_, fixed_);
    const TermEquations equations = equations_of(problem_, free_, weight, target);
    return joined(fixed_, nonnegative_minimum(equations.gram, equations.right, free_), free_);
  }

  const BinProblem& problem_;
  TermSet free_;
  Mixture fixed_{};
};

}  // namespace

ScoringResult score(const BinProblem& problem, const TermSet& free, const ModelPoint* start, double tolerance) {
  const Scoring scoring(problem, free, start);
  ScoringResult result;
  result.at = start != nullptr ? *start : scoring.first_guess();
  result.half_deviance = half_deviance(problem, result.at);
  if (!std::isfinite(result.half_deviance)) {
    // A warm start with a vanishing model: some bin would have no expected power at all.
    result.at = scoring.first_guess();
    result.half_deviance = half_deviance(problem, result.at);
  }
  if (!std::isfinite(result.half_deviance)) return result;
  for (; result.iterations < 200; ++result.iterations) {
    const ModelPoint goal = scoring.goal(result.at);
    double share = 1;
    ModelPoint next = goal;
    double value = half_deviance(problem, next);
    while (!(value <= result.half_deviance) && share > 1e-9) {
      share /= 2;
      next = between(result.at, goal, share);
      value = half_deviance(problem, next);
    }
    if (result.iterations > 8 && share == 1) {
      // Single coefficients bend the likelihood more than their expectation says: full steps may
      // swing about the maximum for long.
      const ModelPoint middle = between(result.at, goal, 0.5);
      const double at_middle = half_deviance(problem, middle);
      if (at_middle < value) {
        next = middle;
        value = at_middle;
      }
    }
    const double gain = result.half_deviance - value;
    if (gain > 0) {
      result.at = next;
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

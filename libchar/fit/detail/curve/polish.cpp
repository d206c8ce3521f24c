// The gamma deviance as a genuine least-squares problem:
//   r_j = sign(u_j - 1) sqrt(nu_j (u_j - 1 - ln u_j)),   sum r^2/2 = -ln L + const,
//   dr/dln mu = nu (1 - u) / (2 r).
// Parameters are ln theta of the terms that scoring left positive, and the shape's coefficients: no bounds, and the
// start is the optimum to within 1e-10, so that one or two Levenberg-Marquardt steps give the last digits. (theta =
// c^2, or ln theta from far away, stalls at a bound or misses the optimum.)

#include "libchar/fit/detail/curve/polish.hpp"

#include <ceres/ceres.h>

#include <cmath>
#include <limits>
#include <utility>

#include "libchar/core/process/silent_glog.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/fit/detail/curve/ceres_options.hpp"

namespace libchar {

ceres::Solver::Options exact_solver_options(int most_iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;  // more give other bits
  options.logging_type = ceres::SILENT;
  options.minimizer_progress_to_stdout = false;
  options.max_num_iterations = most_iterations;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance =
      std::numeric_limits<double>::epsilon();
  return options;
}

ceres::Covariance::Options exact_covariance_options() {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  options.null_space_rank = -1;
  options.num_threads = 1;
  return options;
}

// Where the cost cannot be computed Ceres 2.1 factors an empty matrix.
bool has_covariance(ceres::Problem& problem) {
  double cost = 0;
  return problem.Evaluate({}, &cost, nullptr, nullptr, nullptr) && std::isfinite(cost);
}

namespace {

class BinResiduals final : public ceres::CostFunction {
 public:
  BinResiduals(const BinProblem& problem, std::vector<Eigen::Index> terms)
      : problem_(problem), terms_(std::move(terms)) {
    set_num_residuals(static_cast<int>(problem.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(terms_.size()) + static_cast<int>(problem.shapes()));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const std::size_t p = terms_.size();
    const auto shapes = static_cast<std::size_t>(problem_.shapes());
    std::array<double, kTerms> theta{};
    for (std::size_t i = 0; i < p; ++i) theta[i] = std::exp(parameters[0][i]);
    ShapeCoefficients shape{};
    std::copy_n(parameters[0] + p, shapes, shape.begin());
    const Eigen::ArrayXd gain = shape_of(problem_, shape);
    for (Eigen::Index j = 0; j < problem_.size(); ++j) {
      std::array<double, kTerms> part{};
      double model = 0;
      for (std::size_t i = 0; i < p; ++i) model += part[i] = gain[j] * theta[i] * problem_.unit(j, terms_[i]);
      if (!(model > 0) || !std::isfinite(model)) return false;
      const DevianceResidual r = deviance_residual(problem_.energy[j], model, problem_.dof[j]);
      if (!std::isfinite(r.value) || !std::isfinite(r.slope)) return false;
      residuals[j] = r.value;
      if (jacobians == nullptr || jacobians[0] == nullptr) continue;
      double* const row = jacobians[0] + static_cast<std::size_t>(j) * (p + shapes);
      for (std::size_t i = 0; i < p; ++i) row[i] = r.slope * part[i] / model;
      for (std::size_t s = 0; s < shapes; ++s) row[p + s] = r.slope * problem_.shape(j, static_cast<Eigen::Index>(s));
    }
    return true;
  }

 private:
  const BinProblem& problem_;
  std::vector<Eigen::Index> terms_;
};

}  // namespace

DevianceResidual deviance_residual(double energy, double model, double dof) {
  const double d = (energy - model) / model;
  // shape = 2 (d - ln(1+d)) / d^2, by its series where the difference would lose digits
  double shape = 0;
  if (std::abs(d) < 1e-2) {
    double power = 1;
    for (int k = 2; k <= 12; ++k) {
      shape += 2 * power / k;
      power *= -d;
    }
  } else {
    shape = 2 * detail::deviance_of_bin(energy, model) / (d * d);
  }
  const double root = std::sqrt(dof / 2 * shape);
  return {d * root, -dof / (2 * root)};
}

namespace {

/// Up to the rounding of the sum.
double slack_of(double half_deviance) { return 1e-9 + 1e-13 * half_deviance; }

/// A term without which the likelihood is no worse is at its bound: scoring may only come near it, and its logarithm
/// has no end.
bool take_out_vanished(const BinProblem& problem, ModelPoint& at) {
  bool any = false;
  const double best = half_deviance(problem, at);
  if (!std::isfinite(best)) return false;
  for (double& theta : at.theta) {
    if (!(theta > 0)) continue;
    const double before = std::exchange(theta, 0);
    if (half_deviance(problem, at) <= best + slack_of(best))
      any = true;
    else
      theta = before;
  }
  return any;
}

}  // namespace

Polished polish(const BinProblem& problem, const ModelPoint& scored) {
  const SilentGlog silent;
  ModelPoint start = scored;
  take_out_vanished(problem, start);
  std::vector<Eigen::Index> terms;
  std::vector<double> unknown;
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (!(start.theta[i] > 0)) continue;
    terms.push_back(static_cast<Eigen::Index>(i));
    unknown.push_back(std::log(start.theta[i]));
  }
  const auto shapes = static_cast<std::size_t>(problem.shapes());
  unknown.insert(unknown.end(), start.shape.begin(), start.shape.begin() + static_cast<std::ptrdiff_t>(shapes));
  Polished result;
  result.at = start;
  result.half_deviance = half_deviance(problem, start);
  if (terms.empty()) return result;

  ceres::Problem solver_problem;
  solver_problem.AddResidualBlock(new BinResiduals(problem, terms), nullptr, unknown.data());
  ceres::Solver::Summary summary;
  count_work(WorkKind::descents, 1);
  ceres::Solve(exact_solver_options(50), &solver_problem, &summary);
  result.iterations = static_cast<int>(summary.iterations.size());
  ModelPoint polished;
  for (std::size_t i = 0; i < terms.size(); ++i)
    polished.theta[static_cast<std::size_t>(terms[i])] = std::exp(unknown[i]);
  std::copy_n(unknown.begin() + static_cast<std::ptrdiff_t>(terms.size()), shapes, polished.shape.begin());
  const double value = half_deviance(problem, polished);
  // Never worse than the start. A descent that begins at the maximum may find no step at all, which the solver calls a
  // failure.
  result.converged = value <= result.half_deviance + slack_of(result.half_deviance);
  result.ended = result.converged && summary.termination_type == ceres::CONVERGENCE;
  if (result.converged && take_out_vanished(problem, polished)) return polish(problem, polished);
  if (result.converged) {
    result.at = polished;
    result.half_deviance = value;
  }

  result.known = has_covariance(solver_problem);
  if (!result.known) return result;
  ceres::Covariance covariance(exact_covariance_options());
  const std::size_t p = terms.size(), all = p + shapes;
  std::vector<double> block(all * all);
  const std::vector<std::pair<const double*, const double*>> wanted = {{unknown.data(), unknown.data()}};
  if (covariance.Compute(wanted, &solver_problem) &&
      covariance.GetCovarianceBlock(unknown.data(), unknown.data(), block.data())) {
    for (std::size_t i = 0; i < p; ++i) {
      for (std::size_t j = 0; j < p; ++j) result.covariance(terms[i], terms[j]) = block[i * all + j];
    }
  }
  return result;
}

}  // namespace libchar

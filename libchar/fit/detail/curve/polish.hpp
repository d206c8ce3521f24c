#pragma once
// The last digits of the maximum, and its covariance, by Ceres.

#include <ceres/covariance.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "libchar/fit/detail/band/bin_likelihood.hpp"

namespace libchar {

// How Ceres is asked to solve a small problem, in one place.

/// Levenberg-Marquardt by QR on one thread, until nothing moves any more: all three tolerances at the machine's epsilon. Ceres' own (1e-6,
/// 1e-10, 1e-8) get 19 of NIST's 54 nonlinear problems to four digits, these 53 (tests/fit/strd_nonlinear_test.cpp).
ceres::Solver::Options exact_solver_options(int most_iterations);

/// Of a covariance at the solution, with directions that the data do not determine left out.
ceres::Covariance::Options exact_covariance_options();

/// Can the covariance be asked for at all: has the solver a solution, and the problem a cost where it stands?
bool has_covariance(const ceres::Solver::Summary& summary, ceres::Problem& problem);

struct Polished {
  ModelPoint at;
  double half_deviance = 0;
  TermMatrix covariance = TermMatrix::Zero();  ///< of ln theta of the positive terms
  int iterations = 0;
  bool converged = false;
  bool known = true;  ///< the covariance; else the likelihood cannot be computed around `at`
};

/// Minimises the deviance over ln theta of the positive terms of `start` and over the shape.
Polished polish(const BinProblem& problem, const ModelPoint& start);

/// Residual of one bin, sign(u-1) sqrt(nu (u - 1 - ln u)), and its derivative with respect to ln mu
/// (exact at u = 1 too).
struct DevianceResidual {
  double value = 0, slope = 0;
};
DevianceResidual deviance_residual(double energy, double model, double dof);

}  // namespace libchar

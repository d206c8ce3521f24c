#pragma once
// How Ceres is asked to solve a small problem, in one place. Apart from what tests include: glog, which Ceres brings,
// has a CHECK too.

#include <ceres/covariance.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

namespace libchar {

/// Levenberg-Marquardt by QR on one thread, until nothing moves any more: all three tolerances at the machine's
/// epsilon. Ceres' own (1e-6, 1e-10, 1e-8) get 19 of NIST's 54 nonlinear problems to four digits, these 53
/// (tests/fit/strd_nonlinear_test.cpp).
ceres::Solver::Options exact_solver_options(int most_iterations);

/// Of a covariance at the solution, with directions that the data do not determine left out.
ceres::Covariance::Options exact_covariance_options();

/// Can the covariance be asked for at all: has the problem a cost where the solver left it? One that began at the
/// maximum finds no step and calls that a failure.
bool has_covariance(ceres::Problem& problem);

}  // namespace libchar

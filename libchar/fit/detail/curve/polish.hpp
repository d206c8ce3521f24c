#pragma once
// The last digits of the maximum, and its covariance, by Ceres.

#include "libchar/fit/detail/band/bin_likelihood.hpp"

namespace libchar {

struct Polished {
  ModelPoint at;
  double half_deviance = 0;
  TermMatrix covariance = TermMatrix::Zero();  ///< of ln theta of the positive terms
  int iterations = 0;
  bool converged = false;  ///< not worse than the start
  bool ended = false;      ///< at a maximum, wherever it began
  bool known = true;       ///< the covariance; else the likelihood cannot be computed around `at`
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

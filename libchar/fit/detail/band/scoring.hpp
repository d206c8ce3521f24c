#pragma once
// The maximum of the likelihood by non-negative Fisher scoring.

#include "libchar/fit/detail/band/bin_likelihood.hpp"

namespace libchar {

/// Maximum likelihood over theta >= 0 of the free terms, the others held at `start`, and over the coefficients of the shape.
struct ScoringResult {
  ModelPoint at;
  double half_deviance = 0;
  int iterations = 0;
  bool converged = false;
};
ScoringResult score(const BinProblem& problem, const TermSet& free, const ModelPoint* start = nullptr,
                    double tolerance = 1e-10);

}  // namespace libchar

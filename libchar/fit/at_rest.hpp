#pragma once
// What is surely no sensor at rest: a spectrum above the noise of any of its kind.

#include "libchar/core/numeric/distributions.hpp"

namespace libchar::detail {

/// The loudest sensor of a kind.
struct AtRest {
  double most_density = 0;  ///< two-sided, U²/Hz
  double slowest_hz = 0;    ///< from where on: flicker and walk are above it below

  /// How far a measured density surely is above it: the end of an interval that a record at rest is beyond once in ten
  /// thousand, over `most_density`. 0 where it is too slow, or of fewer than eight degrees of freedom.
  double excess(double frequency_hz, double density, double dof) const {
    constexpr double kSure = 1 - 1e-4, kFewestDof = 8;
    if (frequency_hz < slowest_hz || dof < kFewestDof) return 0;
    return density * dof / chi_square_quantile(kSure, dof) / most_density;
  }
};

}  // namespace libchar::detail

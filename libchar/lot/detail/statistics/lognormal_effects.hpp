#pragma once
// Squares that are each known to some accuracy, some of them so little that zero is as good: noise
// coefficients of a lot, of which some were detected and some were not.
//   ln c_i ~ N(mean, spread²),   E[q_i] = c_i²,   q_i, the estimate of the square, can be below zero

#include <cstddef>
#include <span>

#include "libchar/core/numeric/interval.hpp"

namespace libchar {

/// The estimates of squares, side by side. Scale and unit do not matter.
struct SquareEstimates {
  std::span<const double> square;
  /// By the information at the square, or at zero where it is below: > 0.
  std::span<const double> sd;
  std::span<const double> skewness;  ///< there; 0 or less: not known
  std::span<const double> samples;  ///< of each record: of about one length, errors are of one kind
  /// With r = sd / square, the variance is 1 + excess r / (1 + 1.5 r) times that by the
  /// information.
  double excess = 0;
};

struct LognormalEffects {
  std::size_t count = 0;
  double mean = 0;  ///< of ln c
  Interval mean_ci95;
  double arithmetic = 0;  ///< ln E[c], mean + spread²/2
  Interval arithmetic_ci95;
  double spread = 0;  ///< standard deviation of ln c; 0: nothing of it is seen
  Interval spread_ci95;
};

/// Three values at least, one of them above zero. An end of an interval is infinite where the
/// squares do not end it.
LognormalEffects lognormal_effects(const SquareEstimates& in);

}  // namespace libchar

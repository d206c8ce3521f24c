#pragma once
// How well the mean of a correlated series is known.

#include <span>

namespace libchar {

struct MeanUncertainty {
  double sd = 0;             ///< of the mean; NaN: fewer than eight values
  double reach95 = 0;        ///< half a 95 % interval of the mean: sd times Student's t
  bool long_memory = false;  ///< its correlation does not end within the series
};

/// Of the mean of a stationary series, whatever its correlation.
/// level: share of series of which the interval misses the mean.
MeanUncertainty mean_uncertainty(std::span<const double> series, double level = 0.05);

/// The slope of log Allan variance over log averaging time at the longest five octaves: -1 white, 0
/// flicker, 1 a walk, 2 a drift. NaN: fewer than 128 values.
double slow_slope(std::span<const double> series);

}  // namespace libchar

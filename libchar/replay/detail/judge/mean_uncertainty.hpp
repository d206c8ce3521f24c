#pragma once
// How well the mean of a correlated series is known.

#include <span>

namespace libchar {

struct MeanUncertainty {
  double sd = 0;             ///< of the mean; NaN: fewer than eight values
  double reach95 = 0;        ///< half a 95 % interval of the mean: sd times Student's t
  bool long_memory = false;  ///< its correlation does not end within the series
};

/// The variance of means falls with this power of their length at least, where the correlation does not end. That of
/// squares of normal values falls twice as fast: their correlation is the square of the values' own.
inline constexpr double kEndless = 0.25;

/// Of the mean of a stationary series, whatever its correlation.
/// level: share of series of which the interval misses the mean.
MeanUncertainty mean_uncertainty(std::span<const double> series, double level = 0.05, double endless = kEndless);

/// The slope of log Allan variance over log averaging time at the longest five octaves: -1 white, 0
/// flicker, 1 a walk, 2 a drift. NaN: fewer than 128 values.
double slow_slope(std::span<const double> series);

}  // namespace libchar

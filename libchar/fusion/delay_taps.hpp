#pragma once
// A sampled signal read between its instants.

#include <cstddef>
#include <vector>

namespace libchar::fusion {

/// How a sample between two instants is read. `sinc`: 24 taps, Kaiser window 8, within 0.01 % of the
/// amplitude up to 0.37 of the rate. `cubic`: 4 taps (Lagrange), within 1 % up to 0.12 of the rate;
/// it damps what is faster, most at half a sample, and aliased vibration with it.
enum class Interpolation { sinc, cubic };

/// Weights of the instants floor(delay) + first … of a sample read `delay` instants later.
struct DelayTaps {
  DelayTaps(double delay, Interpolation interpolation);
  /// y(t + delay), of `size` values. Where a tap is missing: linear between its neighbours, NaN
  /// where one of these is missing; `strict`: NaN.
  double at(const double* y, std::ptrdiff_t stride, std::ptrdiff_t size, std::ptrdiff_t t, bool strict = false) const;
  std::vector<double> weights;
  std::ptrdiff_t first = 0, floor = 0;
  double fraction = 0;
};

}  // namespace libchar::fusion

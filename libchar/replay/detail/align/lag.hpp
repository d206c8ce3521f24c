#pragma once
// By how much a sensor comes later than its reference.

#include <limits>
#include <span>

namespace libchar {

struct LagEstimate {
  /// The sensor is later by this; NaN: no lag within the range fits better than its neighbours.
  double lag_s = std::numeric_limits<double>::quiet_NaN();
  /// Coefficient there; NaN when there is no lag, or nothing to compare (constants, hardly any
  /// common samples). Below some 0.3 a lag means little.
  double correlation = std::numeric_limits<double>::quiet_NaN();
};

/// Both on one grid, NaN = missing, of one length (the shorter counts). Lags within +-most_s, at
/// most half the length. A periodic signal has many; the smallest is taken.
LagEstimate estimate_lag(std::span<const double> sensor,
                         std::span<const double> reference,
                         double rate_hz,
                         double most_s);

}  // namespace libchar

#pragma once
// By how much a sensor comes later than its reference.

#include <limits>
#include <span>

#include "libchar/replay/detail/align/instants.hpp"
#include "libchar/replay/replay_result.hpp"

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
LagEstimate estimate_lag(std::span<const double> sensor, std::span<const double> reference, double rate_hz,
                         double most_s);

// The lag between sensors and reference of a scene, estimated.

/// Seconds by which the sensors lag the reference, from the stretch `window`. Throws Error(numeric)
/// when they are too little alike, Error(input) when the reference is slower than the sensors.
double find_lag(const Scene& scene, const Instants& instants, const TimeWindow& window, Progress& progress);

// By how much the reference reads more than the sensors.

/// Mean of (truth - what the sensors say) over instants [from, to), with a 95 % interval whatever
/// the correlation of the difference; as fused (a tilt in rad). Sensors say the least squares of
/// those that are there; of a tilt the angle of gravity. One pass, constant memory. Throws
/// Error(input) for several true inputs, and where fewer than two instants have both.
struct OffsetEstimate {
  double offset = 0, reach95 = 0;
  bool long_memory = false;  ///< the difference drifts within the stretch
};
OffsetEstimate find_reference_offset(const Scene& scene, const Instants& instants, std::int64_t from, std::int64_t to,
                                     Progress& progress);

}  // namespace libchar

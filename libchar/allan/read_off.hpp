#pragma once
// The classical read-off points of an Allan plot, as marks on the plot. They are not estimates: the
// noise fit gives those.

#include <optional>

#include "libchar/allan/allan_deviation.hpp"

namespace libchar {

/// Points of [RV Fig. 1.9] for drawing. A mark is absent when the curve nowhere runs along the line
/// that defines it.
struct ReadOff {
  std::optional<double> white_noise;  ///< Q: the -1/2 line, read at tau = 1 s
  std::optional<double> random_walk;  ///< K: the +1/2 line, read at tau = 3 s
  double minimum = 0;                 ///< of the curve, reliable points first
  double minimum_tau_s = 0;
  /// minimum/0.664: an upper bound of B wherever Q or K matters there
  double bias_instability_upper = 0;
  double white_tau_s = 0, walk_tau_s = 0;  ///< where each line touches the curve; 0 without
};

/// Throws nothing; a curve without points gives a ReadOff without marks.
ReadOff read_off(const AllanCurve& curve);

}  // namespace libchar

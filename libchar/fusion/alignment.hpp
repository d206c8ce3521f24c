#pragma once
// Before fusion: differences between sensors of one quantity other than noise, and their removal.

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "libchar/fusion/delay_taps.hpp"

namespace libchar::fusion {

/// Samples. Searched are 8 of them and, while a delay lies beyond and the stretch is long enough, twice as many.
inline constexpr double kMostDelay = 128;

/// One channel against the common input x:  y(t) = bias + (1 + gain) x(t - delay) + sum m_k c_k(t).
struct ChannelAlignment {
  double delay = 0;           ///< in samples; positive: the channel is late
  double bias = 0, gain = 0;  ///< in units of x; a ratio
  std::vector<double> cross;  ///< m_k, of each other axis
  /// Standard errors (jackknife over stretches, so that correlation counts); NaN: left at nominal.
  double delay_se = kUnknown, bias_se = kUnknown, gain_se = kUnknown;
  std::vector<double> cross_se;
  bool used = true;  ///< false: too few samples, or constant: left as it is
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
};

/// Samples of a channel at or beyond its limits are those of a saturated sensor.
struct ChannelLimits {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool hold(double y) const { return y > low && y < high; }
};

struct Alignment {
  std::vector<ChannelAlignment> channels;
  Interpolation interpolation = Interpolation::sinc;
  std::vector<ChannelLimits> limits;  ///< of all rows of the samples, those of other axes included
  std::int64_t instants = 0;          ///< it was learnt from
  std::vector<std::string> notes;     ///< what the stretch could not tell, sentences
};

}  // namespace libchar::fusion

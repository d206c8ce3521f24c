#pragma once
// Tilt from one gyroscope axis and two accelerometer axes: what all tilt algorithms share.
//   angle of gravity  atan2(a_x, a_z)       [RV 2.7]; atan of the quotient would fold at 90 degrees
// Angles are kept in [-pi, pi]; a difference of two angles is taken the short way round.

#include <cmath>
#include <limits>
#include <numbers>

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {

/// Into [-pi, pi]; leaves an angle that is there already as it is, bit for bit.
inline double wrapped(double angle) {
  constexpr double kTurn = 2 * std::numbers::pi;
  if (std::abs(angle) <= std::numbers::pi) return angle;
  return angle - kTurn * std::round(angle / kTurn);
}

/// The same direction as `angle`, at most half a turn away from `near`.
inline double unwrapped_near(double angle, double near) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const double turns = std::round((near - angle) / kTurn);
  return turns == 0 ? angle : angle + turns * kTurn;
}

/// One instant: rate and angle of gravity, NaN where a sample is missing.
struct TiltSample {
  double rate = std::numeric_limits<double>::quiet_NaN();   ///< rad/s
  double angle = std::numeric_limits<double>::quiet_NaN();  ///< rad
};

inline TiltSample tilt_sample(const TiltChannels& channels, const Sample& y) {
  TiltSample sample;
  if (const double rate = y[channels.gyroscope]; usable(rate)) sample.rate = rate;
  const double x = y[channels.accelerometer_x], z = y[channels.accelerometer_z];
  // Two zeros (free fall, a dead sensor) point nowhere.
  if (usable(x) && usable(z) && (x != 0 || z != 0)) sample.angle = std::atan2(x, z);
  return sample;
}

inline constexpr Needs kTiltNeeds{.min_channels = 3, .accepts_missing = true, .rate = true, .tilt = true};
inline constexpr Option kStartAtZero{
    "start_at_zero",
    "",
    0,
    0,
    1,
    "1: angle zero before the first instant, as in [RV]; 0: the angles of gravity of the start",
    true};
inline constexpr Option kStart{"start_s",
                               "s",
                               1,
                               0,
                               1e6,
                               "time over which the angles of gravity are averaged for the start, carried along by the "
                               "gyroscope; 0: the first angle alone"};

}  // namespace libchar::fusion

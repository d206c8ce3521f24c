#pragma once
// theta_k = lambda (theta_{k-1} + omega_k dt) + (1 - lambda) atan2(a_x, a_z)       [RV 2.6, 2.7]
// lambda = tau / (tau + dt): below the time constant tau the gyroscope is believed, above it
// gravity. lambda = 1 is the gyroscope alone, lambda = 0 the accelerometer alone.
// The start is a mean: the k-th angle of gravity of the first start_s counts max(1 - lambda, 1/k), so
// that one bad sample of the accelerometer is not carried on for ever.

#include <array>

#include "libchar/fusion/tilt_angle.hpp"

namespace libchar::fusion {

/// The filter itself, without options: tuning runs it many times over the same samples.
class ComplementaryFilter {
 public:
  ComplementaryFilter(double lambda, double dt, bool start_at_zero, double start_s = 0)
      : lambda_(lambda),
        dt_(dt),
        start_(start_at_zero ? 0 : std::floor(start_s / dt + 1e-6)),
        angle_(start_at_zero ? 0 : std::nan("")) {}
  /// NaN until the first angle of gravity (unless started at zero).
  double step(const TiltSample& sample);

 private:
  double lambda_, dt_;
  double start_;  // instants whose angles of gravity make the start
  double angle_, heard_ = 0, steps_ = 0;
  double rate_ = 0;  // the last one there was: a missing sample of the gyroscope holds it
};

struct TiltComplementary {
  static constexpr Description description{.name = "tilt-complementary",
                                           .title = "Tilt: complementary filter",
                                           .source = "[RV 2.5]",
                                           .complexity = "O(1)",
                                           .needs = kTiltNeeds};
  static constexpr std::array options{
      Option{"time_constant", "s", 1, 0, 1e9, "tau: gravity is believed beyond it"},
      Option{"lambda", "", -1, -1, 1, "share of the gyroscope at a step; below zero: from the time constant"},
      kStartAtZero, kStart};
  TiltComplementary(const Array& array, const Settings& settings);
  Estimate step(const Sample& y) { return Estimate::scalar(filter_.step(tilt_sample(channels_, y)), std::nan("")); }

 private:
  TiltChannels channels_;
  ComplementaryFilter filter_;
};

/// Baseline: lambda = 1.
struct TiltGyroscope {
  static constexpr Description description{.name = "tilt-gyroscope",
                                           .title = "Tilt: integrated gyroscope",
                                           .source = "[RV 2.5]",
                                           .complexity = "O(1)",
                                           .needs = kTiltNeeds};
  static constexpr std::array options{kStartAtZero, kStart};
  TiltGyroscope(const Array& array, const Settings& settings)
      : channels_(*array.tilt), filter_(1, 1 / array.rate_hz, settings["start_at_zero"] == 1, settings["start_s"]) {}
  Estimate step(const Sample& y) { return Estimate::scalar(filter_.step(tilt_sample(channels_, y)), std::nan("")); }

 private:
  TiltChannels channels_;
  ComplementaryFilter filter_;
};

/// Baseline: the angle of gravity, nothing remembered; no estimate where a sample is missing.
struct TiltAccelerometer {
  static constexpr Description description{.name = "tilt-accelerometer",
                                           .title = "Tilt: angle of gravity",
                                           .source = "[RV 2.7]",
                                           .complexity = "O(1)",
                                           .needs = {.min_channels = 3, .accepts_missing = true, .tilt = true}};
  explicit TiltAccelerometer(const Array& array) : channels_(*array.tilt) {}
  Estimate step(const Sample& y) const { return Estimate::scalar(tilt_sample(channels_, y).angle, std::nan("")); }

 private:
  TiltChannels channels_;
};

}  // namespace libchar::fusion

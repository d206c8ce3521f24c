#pragma once
// Two states, angle theta and gyroscope bias b; the angle of gravity is the measurement.
//   theta' = theta + (omega - b) dt,  b' = b,  Q = diag(angle_noise, bias_noise) dt      [RV 2.5]
// The covariance is kept as P = U diag(d, e) U' with U = [1 c; 0 1] (Bierman 1977): d is the
// variance of the angle if the bias were known, e that of the bias, c what the angle owes to it:
//   P_00 = d + c^2 e,  P_01 = c e,  P_11 = e.
// A missing sample of the gyroscope holds the last rate. After j of them the rate may be off by j
// times what it usually changes in an instant, the angle by h(j) = dt s j (j + 1) / 2 with s^2 the
// running mean square of the changes: d grows by h(j)^2 - h(j-1)^2, so gravity is believed more.
//
// Then prediction is c -= dt and sums of positive terms, and the update multiplies d and e by
// numbers in (0, 1]: nothing is subtracted, so P stays symmetric and positive for ever.

#include <array>

#include "libchar/fusion/tilt_angle.hpp"

namespace libchar::fusion {

struct TiltNoise {
  double angle = 1e-6;    ///< white noise of the rate, rad^2/s
  double bias = 1e-7;     ///< growth of the bias variance, (rad/s)^2/s
  double gravity = 0.01;  ///< variance of the angle of gravity, rad^2
};

/// The filter itself, without options: tuning runs it many times over the same samples.
class TiltKalmanFilter {
 public:
  /// Starts at the first angle of gravity, or at angle zero, bias zero, both known exactly.
  TiltKalmanFilter(const TiltNoise& noise, double dt, double start_bias_variance, bool at_zero);
  /// Angle after the instant; NaN until the first angle of gravity.
  double step(const TiltSample& sample);
  double bias() const { return bias_; }
  double p00() const { return d_ + c_ * c_ * e_; }
  double p01() const { return c_ * e_; }
  double p11() const { return e_; }

 private:
  void predict();
  void update(double gravity);

  double dt_, q_angle_, q_bias_, r_;
  double angle_, bias_ = 0;
  double c_ = 0, d_ = 0, e_;
  void hear(double rate);
  double held_error() const;

  double rate_ = std::numeric_limits<double>::quiet_NaN();  // the last one there was
  double change_square_ = 0, changes_ = 0;                  // of the rate, from instant to instant
  double held_ = 0;                                         // instants since then
};

struct TiltKalman {
  static constexpr Description description{.name = "tilt-kalman",
                                           .title = "Tilt: Kalman filter with gyroscope bias",
                                           .source = "[RV 2.5]; Bierman 1977",
                                           .complexity = "O(1)",
                                           .needs = kTiltNeeds};
  static constexpr std::array options{
      Option{"angle_noise", "rad^2/s", TiltNoise{}.angle, 0, 1e12, "white noise of the rate"},
      Option{"bias_noise", "(rad/s)^2/s", TiltNoise{}.bias, 0, 1e12, "growth of the variance of the gyroscope's bias"},
      Option{"gravity_variance", "rad^2", TiltNoise{}.gravity, 1e-200, 1e200,
             "of the angle of gravity, accelerations of the body included"},
      Option{"start_bias_variance", "(rad/s)^2", 1e-4, 0, 1e12, "of the gyroscope's bias before the first instant"},
      kStartAtZero};
  TiltKalman(const Array& array, const Settings& settings);
  Estimate step(const Sample& y) {
    const double angle = filter_.step(tilt_sample(channels_, y));
    return Estimate::scalar(angle, std::isnan(angle) ? angle : filter_.p00());
  }
  const TiltKalmanFilter& filter() const { return filter_; }

 private:
  TiltChannels channels_;
  TiltKalmanFilter filter_;
};

}  // namespace libchar::fusion

#include "libchar/fusion/algorithms/tilt_kalman.hpp"

#include <algorithm>

namespace libchar::fusion {

TiltKalmanFilter::TiltKalmanFilter(const TiltNoise& noise, double dt, double start_bias_variance, bool at_zero)
    : dt_(dt),
      q_angle_(noise.angle * dt),
      q_bias_(noise.bias * dt),
      r_(noise.gravity),
      angle_(at_zero ? 0 : std::nan("")),
      e_(at_zero ? 0 : start_bias_variance) {}

void TiltKalmanFilter::hear(double rate) {
  constexpr double kMemory = 100;
  if (std::isnan(rate)) {
    held_ += 1;
    return;
  }
  if (held_ == 0 && !std::isnan(rate_)) {
    changes_ = std::min(changes_ + 1, kMemory);
    change_square_ += ((rate - rate_) * (rate - rate_) - change_square_) / changes_;
  }
  rate_ = rate;
  held_ = 0;
}

/// Variance of the angle from rates that were held.
double TiltKalmanFilter::held_error() const {
  const double sum = held_ * (held_ + 1) / 2 * dt_, before = held_ * (held_ - 1) / 2 * dt_;
  return change_square_ * (sum - before) * (sum + before);
}

void TiltKalmanFilter::predict() {
  // No rate ever: none is assumed.
  angle_ = wrapped(angle_ + (std::isnan(rate_) ? 0 : rate_ - bias_) * dt_);
  c_ -= dt_;
  const double grown = e_ + q_bias_;
  if (grown > 0) {
    d_ += q_angle_ + c_ * c_ * e_ * (q_bias_ / grown);
    c_ *= e_ / grown;
  } else {  // the bias is known exactly: the angle owes nothing to it
    d_ += q_angle_;
    c_ = 0;
  }
  e_ = grown;
  if (held_ > 0) d_ += held_error();
}

void TiltKalmanFilter::update(double gravity) {
  const double innovation = unwrapped_near(gravity, angle_) - angle_;
  const double own = d_ + r_, all = own + c_ * c_ * e_;
  const double gain_angle = p00() / all, gain_bias = p01() / all;
  angle_ = wrapped(angle_ + gain_angle * innovation);
  bias_ += gain_bias * innovation;
  e_ *= own / all;
  c_ *= r_ / own;
  d_ *= r_ / own;
}

double TiltKalmanFilter::step(const TiltSample& sample) {
  hear(sample.rate);
  if (std::isnan(angle_)) {
    d_ = r_;
    return angle_ = sample.angle;
  }
  predict();
  if (!std::isnan(sample.angle)) update(sample.angle);
  return angle_;
}

TiltKalman::TiltKalman(const Array& array, const Settings& settings)
    : channels_(*array.tilt),
      filter_({settings["angle_noise"], settings["bias_noise"], settings["gravity_variance"]}, 1 / array.rate_hz,
              settings["start_bias_variance"], settings["start_at_zero"] == 1) {}

}  // namespace libchar::fusion

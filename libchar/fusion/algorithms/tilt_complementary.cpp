#include "libchar/fusion/algorithms/tilt_complementary.hpp"

#include <algorithm>

namespace libchar::fusion {
namespace {

double lambda_of(const Settings& settings, double dt) {
  if (settings["lambda"] >= 0) return settings["lambda"];
  const double tau = settings["time_constant"];
  return tau / (tau + dt);
}

}  // namespace

double ComplementaryFilter::step(const TiltSample& sample) {
  if (!std::isnan(sample.rate)) rate_ = sample.rate;
  if (std::isnan(angle_)) {
    heard_ = 1;
    return angle_ = sample.angle;
  }
  steps_ += 1;
  const double predicted = angle_ + rate_ * dt_;
  if (std::isnan(sample.angle)) return angle_ = wrapped(predicted);
  const double gravity = unwrapped_near(sample.angle, predicted);
  heard_ += 1;
  const double share = steps_ < start_ ? std::max(1 - lambda_, 1 / heard_) : 1 - lambda_;
  return angle_ = wrapped((1 - share) * predicted + share * gravity);
}

TiltComplementary::TiltComplementary(const Array& array, const Settings& settings)
    : channels_(*array.tilt),
      filter_(lambda_of(settings, 1 / array.rate_hz), 1 / array.rate_hz, settings["start_at_zero"] == 1,
              settings["start_s"]) {}

}  // namespace libchar::fusion

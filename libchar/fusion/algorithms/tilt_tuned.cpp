#include "libchar/fusion/algorithms/tilt_tuned.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar::fusion {
namespace {

constexpr double kStartBiasVariance = 1e-4;  // as tilt-kalman's option

/// Best of f over the decades low … high of N numbers: every second decade first, then steps along
/// the axes, halved while none of them helps, down to a tenth of a decade.
template <std::size_t N, class F>
std::array<double, N> best_decades(double low, double high, const F& f) {
  std::array<double, N> at{}, best{};
  double least = std::numeric_limits<double>::infinity();
  const auto try_at = [&](const std::array<double, N>& decades) {
    const double value = f(decades);
    if (!(value < least)) return false;
    least = value;
    best = decades;
    return true;
  };
  at.fill(low);
  for (std::size_t axis = 0; axis < N;) {
    try_at(at);
    for (axis = 0; axis < N; ++axis) {
      if ((at[axis] += 2) <= high) break;
      at[axis] = low;
    }
  }
  for (double step = 1; step >= 0.1;) {
    bool better = false;
    for (std::size_t i = 0; i < 2 * N; ++i) {
      at = best;
      at[i / 2] += i % 2 == 0 ? step : -step;
      better = try_at(at) || better;
    }
    if (!better) step /= 2;
  }
  return best;
}

ComplementaryFilter complementary(double tau_s, double dt_s) {
  return ComplementaryFilter(tau_s / (tau_s + dt_s), dt_s, false, kStart.standard);
}

}  // namespace

void TiltWindow::add(const TiltSample& sample, double truth) {
  if (samples_.size() == kMost) return;
  samples_.push_back(sample);
  truth_.push_back(truth);
}

template <class Filter>
double TiltWindow::mean_square(Filter filter) const {
  double sum = 0, count = 0;
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    const double off = wrapped(filter.step(samples_[k]) - truth_[k]);
    if (k < samples_.size() / 10 || std::isnan(off)) continue;
    sum += off * off;
    count += 1;
  }
  return sum / count;
}

double TiltWindow::gravity_variance() const {
  struct Gravity {
    double step(const TiltSample& sample) const { return sample.angle; }
  };
  const double variance = mean_square(Gravity{});
  if (std::isnan(variance))
    throw numeric_error("E0863")
        .says("the learning window holds no angle of gravity to tune a tilt filter with")
        .hint("look at the accelerometer channels of the scene");
  return std::max(variance, 1e-30);
}

void TiltComplementaryTuned::finish_learning() {
  window_.gravity_variance();  // refuses a window without any
  const auto tau = [](double decades) { return std::pow(10, decades); };
  const auto best = best_decades<1>(std::log10(dt_) - 1, 4, [&](const std::array<double, 1>& at) {
    return window_.mean_square(complementary(tau(at[0]), dt_));
  });
  time_constant_ = tau(best[0]);
  filter_ = complementary(time_constant_, dt_);
}

void TiltComplementaryTuned::exchange(LearntExchange& with) {
  with.number("time_constant_s", time_constant_);
  if (with.taking_in()) filter_ = complementary(time_constant_, dt_);
}

Estimate TiltComplementaryTuned::step(const Sample& y) {
  if (!filter_) return Estimate::none(1);
  return Estimate::scalar(filter_->step(tilt_sample(channels_, y)), std::nan(""));
}

void TiltComplementaryTuned::remarks(Findings& warnings) const {
  if (filter_) warnings.add("tilt_tuned", "time constant " + brief_text(time_constant_) + " s");
}

void TiltKalmanTuned::finish_learning() {
  const double r = window_.gravity_variance();
  const auto noise = [&](const std::array<double, 2>& at) {
    return TiltNoise{r * std::pow(10, at[0]), r * std::pow(10, at[1]), r};
  };
  const auto best = best_decades<2>(-10, 2, [&](const std::array<double, 2>& at) {
    return window_.mean_square(TiltKalmanFilter(noise(at), dt_, kStartBiasVariance, false));
  });
  noise_ = noise(best);
  filter_.emplace(noise_, dt_, kStartBiasVariance, false);
}

void TiltKalmanTuned::exchange(LearntExchange& with) {
  with.number("angle_noise", noise_.angle);
  with.number("bias_noise", noise_.bias);
  with.number("gravity_variance", noise_.gravity);
  if (with.taking_in()) filter_.emplace(noise_, dt_, kStartBiasVariance, false);
}

Estimate TiltKalmanTuned::step(const Sample& y) {
  if (!filter_) return Estimate::none(1);
  const double angle = filter_->step(tilt_sample(channels_, y));
  return Estimate::scalar(angle, std::isnan(angle) ? angle : filter_->p00());
}

void TiltKalmanTuned::remarks(Findings& warnings) const {
  if (filter_)
    warnings.add("tilt_tuned", "angle_noise " + brief_text(noise_.angle) + " rad^2/s, bias_noise " +
                                   brief_text(noise_.bias) + " (rad/s)^2/s, gravity_variance " +
                                   brief_text(noise_.gravity) + " rad^2");
}

}  // namespace libchar::fusion

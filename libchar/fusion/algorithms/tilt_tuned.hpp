#pragma once
// Tilt filters whose constants are chosen in the learning window: the ones with which the filter
// comes nearest to the reference there (root mean square of the angle, taken the short way round).
//   complementary  tau, searched over its logarithm
//   Kalman         angle_noise and bias_noise, over their logarithms; the variance of the angle of
//                  gravity is measured, against the reference
// The run itself starts afresh: between window and run any time may have passed.

#include <optional>
#include <vector>

#include "libchar/fusion/algorithms/tilt_complementary.hpp"
#include "libchar/fusion/algorithms/tilt_kalman.hpp"

namespace libchar::fusion {

inline constexpr Needs kTiltTunedNeeds{
    .min_channels = 3, .learning_samples = 200, .reference = true, .accepts_missing = true, .rate = true, .tilt = true};

/// The learning window, at most kMost instants of it. An instant without a truth (NaN) is not
/// judged, but the filters run through it.
class TiltWindow {
 public:
  static constexpr std::size_t kMost = 50000;
  void add(const TiltSample& sample, double truth);
  /// Mean square error of anything with step(TiltSample), without the first tenth (its start).
  template <class Filter>
  double mean_square(Filter filter) const;
  /// Mean square error of the angle of gravity. Throws Error(numeric): it never has one.
  double gravity_variance() const;

 private:
  std::vector<TiltSample> samples_;
  std::vector<double> truth_;
};

/// What both hold beside their filter.
class TiltTuned {
 public:
  explicit TiltTuned(const Array& array) : channels_(*array.tilt), dt_(1 / array.rate_hz) {}
  void learn(const Sample& y, const Sample& truth) { window_.add(tilt_sample(channels_, y), truth[0]); }
  void skip(const Sample& y) { window_.add(tilt_sample(channels_, y), std::nan("")); }

 protected:
  TiltChannels channels_;
  double dt_;
  TiltWindow window_;
};

struct TiltComplementaryTuned : TiltTuned {
  static constexpr Description description{.name = "tilt-complementary-tuned",
                                           .title = "Tilt: complementary filter, time constant learnt",
                                           .source = "[RV 2.5]",
                                           .complexity = "O(1)",
                                           .needs = kTiltTunedNeeds,
                                           .learning_complexity = "about 50 runs of the filter"};
  using TiltTuned::TiltTuned;
  void finish_learning();
  void exchange(LearntExchange& with);
  Estimate step(const Sample& y);
  void remarks(Findings& warnings) const;

 private:
  double time_constant_ = 0;
  std::optional<ComplementaryFilter> filter_;
};

struct TiltKalmanTuned : TiltTuned {
  static constexpr Description description{.name = "tilt-kalman-tuned",
                                           .title = "Tilt: Kalman filter, noise learnt",
                                           .source = "[RV 2.5]; Bierman 1977",
                                           .complexity = "O(1)",
                                           .needs = kTiltTunedNeeds,
                                           .learning_complexity = "about 150 runs of the filter"};
  using TiltTuned::TiltTuned;
  void finish_learning();
  void exchange(LearntExchange& with);
  Estimate step(const Sample& y);
  void remarks(Findings& warnings) const;

 private:
  TiltNoise noise_;
  std::optional<TiltKalmanFilter> filter_;
};

}  // namespace libchar::fusion

#pragma once
// One sensor made of several whose drifts are known as models: a Kalman filter of the biases alone.
//   y = H x + C b + e,  R = diag(white),  b: states of first order (bias_filter.hpp)
// Nothing is assumed of the input x (its variance is infinite at every instant), so only what the samples
// tell beside any input - the differences between sensors - is filtered (Bayard & Ploen 2003; Xue et al.
// 2012). With P the prediction covariance of b and S = C P C' + R:
//   W = (H' S^-1 H)^-1 H' S^-1,  x = W (y - C b),  var x = (H' S^-1 H)^-1
//   b <- A (b + P C' S^-1 (I - H W)(y - C b)),   P by the Riccati equation (bias_filter.hpp)
// P does not depend on the samples. It is computed beforehand at instants 0 to 16 and four times an
// octave after, by doubling (as accurate as a square root form: nothing is subtracted), and stands in
// between; a step is a product with the gain that holds. Short gaps take P as if they were none.
//
// With an input model (input_deviation above zero; never the default) each input is a state too, white
// noise behind two poles at input_corner_hz, x'' + 2 w x' + w^2 x = noise, of that deviation about zero;
// sampled it is an AR(2) process. Then nothing is projected out: the ordinary filter of [x, x'/w, b].
//
// With smoothed=1 the estimates are those of all samples of the run, before and after (bias_smoother.hpp).
//
// White noise weighs by 1/Q^2 within an instant, drift by its own share over minutes: sensors with
// little white noise and much drift, and others the other way round, come to what no fixed weights give.

#include <array>
#include <memory>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/bias/bias_filter.hpp"
#include "libchar/fusion/detail/bias/bias_smoother.hpp"

namespace libchar::fusion {

struct VirtualSensor {
  static constexpr Description description{.name = "virtual-sensor",
                                           .title = "Virtual sensor: Kalman filter of the sensors' drifts, any input",
                                           .source = "Bayard & Ploen 2003; Xue et al. 2012",
                                           .complexity = "O(n s), s states of drift",
                                           .needs = {.max_channels = kMostPaired,
                                                     .more_than_inputs = 1,
                                                     .noise_models = true,
                                                     .observation_matrix = true,
                                                     .accepts_missing = true,
                                                     .rate = true}};
  static constexpr std::array options{
      Option{"slowest_s", "s", 1e4, 1, 1e9, "no process that makes up flicker is slower"},
      Option{"most_states", "", 100, 1, 2000, "of all drifts; more are refused", true},
      Option{"input_deviation", "U", 0, 0, 1e100,
             "of the input about zero, for a model of it; 0: nothing is assumed of the input"},
      Option{"input_corner_hz", "Hz", 1, 1e-9, 1e9, "of that model: double pole of the input's spectrum"},
      Option{"smoothed", "", 0, 0, 1,
             "1: each estimate from the whole run, what comes after it as well (a smoother, for logs); 0: from what "
             "came before (a filter)",
             true},
      Option{"most_mb", "MB", 1000, 1, 1e9, "of the run that the smoother keeps; more is refused"}};
  VirtualSensor(const Array& array, const Settings& settings);
  static double cost_ns(const Array& array, const Settings& settings) {
    return (looks_ahead(settings) ? 40.0 : 10.0) * static_cast<double>(array.channels * array.inputs());
  }
  static bool looks_ahead(const Settings& settings) { return settings["smoothed"] == 1; }
  void look(const Sample& y) { smoother_->look(y); }
  void finish_learning();
  Estimate step(const Sample& y) { return smoother_ ? smoother_->step() : filter_->step(y); }
  Eigen::MatrixXd weights() const { return filter().weights(); }
  void remarks(Findings& warnings) const;

 private:
  const BiasFilter& filter() const { return smoother_ ? smoother_->filter() : *filter_; }
  std::unique_ptr<BiasFilter> filter_;      // holds pointers into itself
  std::unique_ptr<BiasSmoother> smoother_;  // has the filter where there is one
};

}  // namespace libchar::fusion

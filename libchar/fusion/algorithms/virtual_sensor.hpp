#pragma once
// One sensor made of several whose drifts are known as models: a Kalman filter of the biases alone.
//   y = H x + C b + e,  R = diag(white),  b: states of first order (bias_states.hpp)
// Nothing is assumed of the input x (its variance is infinite at every instant), so only what the samples
// tell beside any input - the differences between sensors - is filtered (Bayard & Ploen 2003; Xue et al.
// 2012). With P the prediction covariance of b and S = C P C' + R:
//   W = (H' S^-1 H)^-1 H' S^-1,  x = W (y - C b),  var x = (H' S^-1 H)^-1
//   b <- A (b + P C' S^-1 (I - H W)(y - C b)),   P by the Riccati equation (riccati.hpp)
// P does not depend on the samples. It is computed beforehand at instants 0 to 16 and four times an
// octave after, by doubling (as accurate as a square root form: nothing is subtracted), and stands in
// between; a step is a product with the gain that holds. Short gaps take P as if they were none.
//
// With an input model (input_deviation above zero; never the default) each input is a state too, white
// noise behind two poles at input_corner_hz, x'' + 2 w x' + w^2 x = noise, of that deviation about zero;
// sampled it is an AR(2) process. Then nothing is projected out: the ordinary filter of [x, x'/w, b].
//
// White noise weighs by 1/Q^2 within an instant, drift by its own share over minutes: sensors with
// little white noise and much drift, and others the other way round, come to what no fixed weights give.

#include <array>
#include <memory>
#include <vector>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/bias_states.hpp"

namespace libchar::fusion {

/// Gains for one set of channels, from one prediction covariance.
struct BiasGain {
  std::vector<char> present;       ///< of each channel
  Eigen::MatrixXd weights;         ///< W, r x n; zero for absent channels
  Eigen::MatrixXd gain;            ///< of the states, s x n
  Eigen::VectorXd input_variance;  ///< r
  bool determined = false;         ///< these channels determine the inputs
};

/// What is assumed of the inputs; nothing: deviation 0.
struct InputModel {
  double deviation = 0;  ///< U, about zero
  double corner_hz = 1;  ///< of both poles
};

/// The filter without options and names; everything is allocated when it is made.
class BiasFilter {
 public:
  BiasFilter(const Array& array,
             double slowest_s,
             Eigen::Index most_states,
             const InputModel& input = {});
  Estimate step(const Sample& y);
  /// n x r, of the samples of the last instant.
  Eigen::MatrixXd weights() const;
  /// Steady state of the prediction covariance of the states, and of the inputs' variances.
  const Eigen::MatrixXd& steady_covariance() const { return steady_; }
  Eigen::VectorXd steady_variance() const { return input_variance_of_steady_; }
  const BiasStates& states() const { return states_; }

 private:
  struct Renewal {
    double instant;
    Eigen::MatrixXd cross;  // P C', s x n
    Eigen::VectorXd input;  // variances of the inputs before the samples, where they are states
  };
  void add_inputs(const InputModel& input, double rate_hz);
  void note(double instant, const Eigen::MatrixXd& p);
  void schedule();
  void renew(const Renewal& renewal);
  void factor(BiasGain& out);
  void decompose();
  void forward();
  void backward();
  bool invert_information();
  const BiasGain& gain_for(const Sample& y);

  Eigen::Index state_of_input(Eigen::Index j) const { return states_.size() + 2 * j; }
  void propagate();

  Eigen::MatrixXd h_;
  bool common_;    // one input, seen alike by all
  bool modelled_;  // inputs are states too
  BiasStates states_;
  Eigen::MatrixXd seen_;  // C, n x s, inputs that are states behind the biases
  Eigen::MatrixXd transition_, drive_, start_;  // of all states
  Eigen::VectorXd white_;
  Eigen::MatrixXd steady_;
  Eigen::VectorXd input_variance_of_steady_;
  std::vector<Renewal> renewals_;
  std::size_t next_ = 0;
  const Renewal* renewal_ = nullptr;
  // Gains of the sets of channels seen last; the first is that of all channels.
  std::vector<BiasGain> gains_;
  std::size_t oldest_ = 1;
  const BiasGain* now_;
  // Room for `factor` and `step`.
  Eigen::MatrixXd lower_, whitened_, square_, inverse_;
  Eigen::VectorXd residual_, column_, bias_, fitted_;
  std::vector<Eigen::Index> used_;
  double instant_ = 0;
};

struct VirtualSensor {
  static constexpr Description description{
      .name = "virtual-sensor",
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
      Option{"input_deviation",
             "U",
             0,
             0,
             1e100,
             "of the input about zero, for a model of it; 0: nothing is assumed of the input"},
      Option{"input_corner_hz",
             "Hz",
             1,
             1e-9,
             1e9,
             "of that model: double pole of the input's spectrum"}};
  VirtualSensor(const Array& array, const Settings& settings);
  Estimate step(const Sample& y) { return filter_->step(y); }
  Eigen::MatrixXd weights() const { return filter_->weights(); }
  void remarks(Warnings& warnings) const;

 private:
  std::unique_ptr<BiasFilter> filter_;  // holds pointers into itself
};

}  // namespace libchar::fusion

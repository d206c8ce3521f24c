#pragma once
// The Kalman filter of virtual_sensor.hpp, where its equations stand, without options and names.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/array.hpp"

namespace libchar::fusion {

/// The discrete Riccati equation of a filter:
///   P' = F P (I + G P)^-1 F' + Q,  G = C' M C, M = R^-1, or beside an input H x that is not known
///   M = R^-1 - R^-1 H (H' R^-1 H)^-1 H' R^-1
/// 2^j steps at once have the same form (Anderson 1978; structured doubling, Chu, Fan, Lin 2005):
///   P_k+m = H_j + A_j' P_k (I + G_j P_k)^-1 A_j
///   A_j+1 = A_j (I + G_j H_j)^-1 A_j,  G_j+1 = G_j + A_j (I + G_j H_j)^-1 G_j A_j',
///   H_j+1 = H_j + A_j' H_j (I + G_j H_j)^-1 A_j;   H_j -> the steady state
/// In the operators A_0 = F', the transposed system.
class RiccatiSteps {
 public:
  RiccatiSteps(const Eigen::MatrixXd& transition, const Eigen::MatrixXd& drive, const Eigen::MatrixXd& information);
  /// Prediction covariance after as many steps as the operator stands for.
  Eigen::MatrixXd advance(const Eigen::MatrixXd& p) const;
  /// Twice as many steps.
  void twice();
  /// Doubles until nothing changes any more; then H is the steady state.
  const Eigen::MatrixXd& steady();

 private:
  Eigen::MatrixXd a_, g_, h_;
};

/// A sensor's drift as states of first order, b_k+1 = phi b_k + w, var(w) = drive:
///   Gauss-Markov     phi = exp(-dt/tau), drive = sigma^2 (1 - phi^2), starts with variance sigma^2
///   flicker B        sum of Gauss-Markov processes a decade apart in tau, each of variance B^2 ln(10)/pi:
///                    their densities add up to B^2/(2 pi f) within 6 %       (van der Ziel 1950; Keshner 1982)
///   walk K           drive K^2 dt, tau ten times the slowest flicker, starts with variance zero
/// Flicker is followed between the frequency where white noise hides it and the one where the walk does.
struct BiasStates {
  Eigen::VectorXd pole, drive, start;  ///< phi, variance a step, variance before the first instant
  std::vector<Eigen::Index> channel;   ///< whose samples it is in
  Eigen::Index size() const { return pole.size(); }
};

/// `slowest_s`: no process of flicker is slower.
BiasStates bias_states(const std::vector<NoiseModel>& models, double rate_hz, double slowest_s);

/// Gains for one set of channels, from one prediction covariance.
struct BiasGain {
  std::vector<char> present;       ///< of each channel
  Eigen::MatrixXd weights;         ///< W, r x n; zero for absent channels
  Eigen::MatrixXd gain;            ///< of the states, s x n
  Eigen::VectorXd input_variance;  ///< r
  bool determined = false;         ///< these channels determine the inputs
  // For a smoother only (bias_smoother.hpp):
  Eigen::MatrixXd information;  ///< C' S^-1 (I - H W), s x n
  Eigen::MatrixXd coupling;     ///< minus the covariance of input and states after the samples, r x s
  std::uint64_t version = 0;    ///< another one: other gains
};

/// What is assumed of the inputs; nothing: deviation 0.
struct InputModel {
  double deviation = 0;  ///< U, about zero
  double corner_hz = 1;  ///< of both poles
};

/// Everything is allocated when it is made.
class BiasFilter {
 public:
  /// `for_smoother`: keeps what a smoother asks for.
  BiasFilter(const Array& array, double slowest_s, Eigen::Index most_states, const InputModel& input = {},
             bool for_smoother = false);
  Estimate step(const Sample& y);
  /// n x r, of the samples of the last instant.
  Eigen::MatrixXd weights() const;
  /// Steady state of the prediction covariance of the states, and of the inputs' variances.
  const Eigen::MatrixXd& steady_covariance() const { return steady_; }
  Eigen::VectorXd steady_variance() const { return input_variance_of_steady_; }
  const BiasStates& states() const { return states_; }

  // For a smoother, made with `for_smoother`:
  /// y - C b of the last instant before its samples corrected b; zero where there is no sample.
  const Eigen::VectorXd& residual() const { return residual_; }
  /// Which of the prediction covariances holds at this instant, and that covariance (s x s).
  std::size_t epoch_at(double instant) const;
  const Eigen::MatrixXd& covariance(std::size_t epoch) const { return renewals_[epoch].covariance; }
  /// The gains of an epoch for the channels that have a sample; for those that follow as well.
  const BiasGain& gain_in(std::size_t epoch, const Sample& y);
  /// A and its noise, all states; C' R^-1 C beside any input.
  const Eigen::MatrixXd& transition() const { return transition_; }
  const Eigen::MatrixXd& drive() const { return drive_; }
  const Eigen::MatrixXd& seen() const { return seen_; }
  Eigen::MatrixXd information() const;
  /// v <- A' v.
  void pull_back(Eigen::VectorXd& v) const;

 private:
  struct Renewal {
    double instant;
    Eigen::MatrixXd cross;            // P C', s x n
    Eigen::VectorXd input;            // variances of the inputs before the samples, where they are states
    Eigen::MatrixXd covariance = {};  // P, for a smoother
  };
  void add_inputs(const InputModel& input, double rate_hz);
  void note(double instant, const Eigen::MatrixXd& p);
  void schedule();
  void renew(const Renewal& renewal);
  void factor(BiasGain& out);
  template <class Source>
  void project(const Source& source, const Eigen::MatrixXd& weights, Eigen::MatrixXd& into);
  void couple(BiasGain& out) const;
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
  bool for_smoother_;
  std::uint64_t version_ = 0;
  BiasStates states_;
  Eigen::MatrixXd seen_;                        // C, n x s, inputs that are states behind the biases
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

}  // namespace libchar::fusion

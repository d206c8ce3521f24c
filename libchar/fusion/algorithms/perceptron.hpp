#pragma once
// A tanh network (network_training.hpp) that learns the input from all channels at once, by
// Levenberg-Marquardt on   sum_k (out(z_k) - t_k)^2   over the learning window            [RV 3.7]
// z and t are channels and reference with mean zero and deviation one, so an offset costs nothing.
// Of several seeded starts the one that does best on the last part of the window (not used for the
// slopes) is kept, as it stood where that part was predicted best. A window longer than the room is
// sampled (Vitter 1985, algorithm R): even thinning would learn one phase of a periodic input.

#include <array>
#include <cstdint>
#include <vector>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/network/network_training.hpp"
#include "libchar/fusion/detail/uniform.hpp"

namespace libchar::fusion {

struct Perceptron {
  static constexpr Description description{.name = "perceptron",
                                           .title = "Perceptron: a tanh network trained in the learning window",
                                           .source = "[RV 3.7]",
                                           .complexity = "O(n h), h hidden neurons",
                                           .needs = {.learning_samples = 100, .reference = true},
                                           .learning_complexity = "O((n h)^2) an iteration"};
  static constexpr std::array options{
      Option{"neurons", "", 10, 1, 64, "h: hidden neurons; 3 to 30 make sense", true},
      Option{"starts", "", 3, 1, 100, "trainings from different random weights", true},
      Option{"seed", "", 1, 0, 9007199254740992.0, "of the random weights and of the choice of samples", true},
      Option{"held_out", "", 0.2, 0.05, 0.5,
             "last share of the learning window: it stops the training and chooses the start"},
      Option{"iterations", "", 100, 1, 10000, "at most, a start", true},
      Option{"most_samples", "samples", 10000, 100, 1e7,
             "kept for training: of a longer window as many at random, each as likely", true},
      Option{"most_weights", "", 300, 10, 1e5,
             "of the network; wide arrays get fewer neurons, as time grows with the square", true}};

  Perceptron(const Array& array, const Settings& settings);
  void learn(const Sample& y, const Sample& truth);
  /// Throws Error(numeric): fewer instants than twice the number of weights, or no start gave numbers.
  void finish_learning();
  void exchange(LearntExchange& with);
  Estimate step(const Sample& y);
  void remarks(Findings& warnings) const;

  /// For tests: same learning, same parameters, bit for bit.
  const std::vector<double>& parameters() const { return parameters_; }
  const TanhNetwork& network() const { return network_; }

 private:
  struct Scale {
    double mean = 0, deviation = 1;
  };
  static Scale scale_of(const Eigen::Ref<const Eigen::VectorXd>& values);
  void put_in_order();
  void standardise();

  TanhNetwork network_;
  std::size_t asked_;  // neurons
  std::vector<double> parameters_;
  std::vector<Scale> scales_;  // of the channels
  Scale target_;
  std::vector<double> z_;  // standardised samples of one instant
  double variance_ = 0;    // of the error on the held-out part
  // The learning window: n + 1 values an instant, the reference last.
  std::vector<double> window_;
  std::size_t kept_ = 0, most_, seen_ = 0;
  std::vector<std::size_t> when_;  // of each instant kept: its place in the window
  Uniform choice_;                 // of what a full window keeps
  std::size_t starts_, iterations_;
  std::uint64_t seed_;
  double held_out_;
};

}  // namespace libchar::fusion

#pragma once
// What could be had with the reference of the run itself: bounds to compare with, not methods.
//   best-sensor              the one channel of the smallest error
//   optimal-weights          least squares over the whole run, sum w = 1
//   sectioned-least-squares  the same for each section between the given instants [RV 5.1.2]

#include <array>
#include <vector>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/algorithms/least_squares.hpp"

namespace libchar::fusion {

struct BestSensor {
  static constexpr Description description{.name = "best-sensor",
                                           .title = "Best single channel (bound)",
                                           .source = "[RV 3.11]",
                                           .complexity = "O(1)",
                                           .needs = {.reference_throughout = true, .accepts_missing = true},
                                           .learning_complexity = "O(n)"};
  explicit BestSensor(const Array& array);
  void learn(const Sample& y, const Sample& truth);
  void finish_learning();
  Estimate step(const Sample& y) const;
  Eigen::MatrixXd weights() const;

 private:
  Eigen::VectorXd squares_, counts_;
  std::vector<int> order_;  // best first
};

struct OptimalWeights : ReferenceWeightedMean {
  static constexpr Description description{
      .name = "optimal-weights",
      .title = "Optimal fixed weights (bound)",
      .source = "[RV 3.25]",
      .complexity = "O(n)",
      .needs = {.max_channels = kMostPaired, .reference_throughout = true, .accepts_missing = true},
      .learning_complexity = "O(n^2)"};
  static constexpr std::array options{
      Option{"calibrate", "", 0, 0, 1, "1: gain and bias of each channel are learnt first", true}};
  OptimalWeights(const Array& array, const Settings& settings)
      : ReferenceWeightedMean({settings["calibrate"] != 0, true, false}, array.channels, description.name) {}
};

/// Learns on instants 0, 1, … of the run and runs on the same: the k-th instant learnt or skipped
/// is the k-th instant run.
struct SectionedLeastSquares {
  static constexpr Description description{
      .name = "sectioned-least-squares",
      .title = "Least squares, section by section (bound)",
      .source = "[RV 5.1.2]",
      .complexity = "O(n)",
      .needs = {.max_channels = kMostPaired, .reference_throughout = true, .accepts_missing = true},
      .learning_complexity = "O(n^2)"};
  static constexpr std::array options{
      Option{"calibrate", "", 0, 0, 1, "1: gain and bias of each channel are learnt first", true}};
  SectionedLeastSquares(const Array& array, const Settings& settings);
  void learn(const Sample& y, const Sample& truth);
  void skip(const Sample&) { ++learnt_; }
  void finish_learning();
  Estimate step(const Sample& y);
  Eigen::MatrixXd weights() const;

 private:
  std::size_t section(std::int64_t instant, std::size_t from) const;
  LeastSquaresForm form_;
  std::vector<std::int64_t> starts_;  // of the sections after the first
  std::vector<WeightLearner> learners_;
  std::vector<LearntMean> means_;
  std::int64_t learnt_ = 0, now_ = 0;
  std::size_t learning_ = 0, running_ = 0;
};

}  // namespace libchar::fusion

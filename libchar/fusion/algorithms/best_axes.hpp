#pragma once
// Of all axes the r that together tell the inputs best, and nothing of the others (after Faizullin &
// Ferrer 2021, best axes composition of several inertial units): with d_i the mean square error of
// channel i against the reference of the learning window, the set S of r channels with
//   least  trace (H_S' D_S^-1 H_S)^-1,   x = H_S^-1 y_S
// Their choice follows the motion while a reference lasts; here it stands after the learning window, and
// follows the channels that have a sample. With one input: the best single sensor as learnt beforehand.
// S: rows of largest volume first (Gram-Schmidt on h_i / sqrt d_i), then exchanged one by one while that helps.

#include <array>
#include <vector>

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {

/// r of the channels, and what they make of the inputs.
struct ChosenAxes {
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxStates, kMaxStates>;
  std::array<Eigen::Index, kMaxStates> channels{};
  Square inverse;  ///< H_S^-1, r x r
  State variance;  ///< of the inputs
  bool determined = false;
};

/// The best r of those with a mean square error above zero and finite; the others do not count.
/// h: n x r. Makes no trip to the heap.
ChosenAxes choose_axes(const Eigen::MatrixXd& h, const Eigen::VectorXd& mean_squares);

struct BestAxes {
  static constexpr Description description{
      .name = "best-axes",
      .title = "Best axes: as many channels as inputs, chosen in the learning window",
      .source = "after Faizullin & Ferrer 2021",
      .complexity = "O(n + r^2)",
      .needs = {.more_than_inputs = 1,
                .learning_samples = 2,
                .reference = true,
                .observation_matrix = true,
                .accepts_missing = true},
      .learning_complexity = "O(n r)"};
  explicit BestAxes(const Array& array);
  void learn(const Sample& y, const Sample& truth);
  void finish_learning();
  Estimate step(const Sample& y);
  Eigen::MatrixXd weights() const;
  void exchange(LearntExchange& with);

 private:
  void choose_all();
  Eigen::MatrixXd h_;
  Eigen::VectorXd squares_, counts_;  // then mean squares, -1: never seen
  Eigen::VectorXd present_squares_;
  std::vector<char> present_;
  ChosenAxes all_, now_;
};

}  // namespace libchar::fusion

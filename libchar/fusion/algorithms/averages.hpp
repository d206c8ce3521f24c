#pragma once
// The middle sample (the mean of the two middle ones): no model, and right while less than half of
// the channels are wrong.

#include <memory>
#include <vector>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/variances/generalized_least_squares.hpp"

namespace libchar::fusion {

// x = sum w_i y_i, w_i = (1/v_i) / sum_j 1/v_j, with noise variances v that are known beforehand
// [RV 4.12]. For several inputs, or gains that differ, generalized least squares:
// X = (H' R^-1 H)^-1 H' R^-1 y, R = diag(v).

struct InverseVariance {
  static constexpr Description description{
      .name = "inverse-variance",
      .title = "Inverse-variance weights from known noise levels",
      .source = "[RV 4.12]",
      .complexity = "O(n r)",
      .needs = {.noise_levels = true, .observation_matrix = true, .accepts_missing = true}};
  explicit InverseVariance(const Array& array);
  Estimate step(const Sample& y) const;
  Eigen::MatrixXd weights() const { return general_ ? general_->weights() : Eigen::MatrixXd(weights_); }
  Eigen::VectorXd variances() const { return levels_; }

 private:
  Eigen::VectorXd levels_, weights_;
  double variance_;
  std::unique_ptr<GeneralMean> general_;  // any H but a column of ones
};

// x = (1/n) sum y_i: what every other algorithm is measured against. For several inputs, or gains
// that differ, ordinary least squares: X = (H'H)^-1 H' y.

struct Mean {
  static constexpr Description description{.name = "mean",
                                           .title = "Mean (ordinary least squares for several inputs)",
                                           .source = "[RV 3.4]",
                                           .complexity = "O(n r)",
                                           .needs = {.observation_matrix = true, .accepts_missing = true}};
  explicit Mean(const Array& array);
  Estimate step(const Sample& y) const;
  Eigen::MatrixXd weights() const;

 private:
  Estimate unweighted(const Sample& y) const;
  Estimate of_present(const Sample& y) const;
  Eigen::VectorXd levels_;  // noise variances, empty: not known
  Eigen::Index channels_;
  double variance_;
  std::unique_ptr<GeneralMean> general_;  // any H but a column of ones
};

struct Median {
  static constexpr Description description{.name = "median",
                                           .title = "Median",
                                           .source = "Tukey 1977",
                                           .complexity = "O(n)",
                                           .needs = {.accepts_missing = true},
                                           .withstands = 1};
  explicit Median(const Array& array) : sorted_(static_cast<std::size_t>(array.channels)) {}
  Estimate step(const Sample& y);

 private:
  std::vector<double> sorted_;
};

}  // namespace libchar::fusion

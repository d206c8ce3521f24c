#pragma once
// x = sum w_i y_i, w_i = (1/v_i) / sum_j 1/v_j, with noise variances v that are known beforehand
// [RV 4.12]. For several inputs, or gains that differ, generalized least squares:
// X = (H' R^-1 H)^-1 H' R^-1 y, R = diag(v).

#include <memory>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/variances/general_mean.hpp"

namespace libchar::fusion {

struct InverseVariance {
  static constexpr Description description{
      .name = "inverse-variance",
      .title = "Inverse-variance weights from known noise levels",
      .source = "[RV 4.12]",
      .complexity = "O(n r)",
      .needs = {.noise_levels = true, .observation_matrix = true, .accepts_missing = true}};
  explicit InverseVariance(const Array& array);
  Estimate step(const Sample& y) const;
  Eigen::MatrixXd weights() const {
    return general_ ? general_->weights() : Eigen::MatrixXd(weights_);
  }
  Eigen::VectorXd variances() const { return levels_; }

 private:
  Eigen::VectorXd levels_, weights_;
  double variance_;
  std::unique_ptr<GeneralMean> general_;  // any H but a column of ones
};

}  // namespace libchar::fusion

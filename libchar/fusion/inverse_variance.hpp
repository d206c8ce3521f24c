#pragma once
// x = sum w_i y_i, w_i = (1/v_i) / sum_j 1/v_j, with noise variances v that are known beforehand
// [RV 4.12].

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {

struct InverseVariance {
  static constexpr Card card{.name = "inverse-variance",
                             .title = "Inverse-variance weights from known noise levels",
                             .source = "[RV 4.12]",
                             .complexity = "O(n)",
                             .needs = {.noise_levels = true, .accepts_missing = true}};
  explicit InverseVariance(const Given& given);
  Estimate step(const Sample& y) const;
  Eigen::MatrixXd weights() const { return weights_; }
  Eigen::VectorXd variances() const { return levels_; }

 private:
  Eigen::VectorXd levels_, weights_;
  double variance_;
};

}  // namespace libchar::fusion

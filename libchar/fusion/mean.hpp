#pragma once
// x = (1/n) sum y_i: what every other algorithm is measured against.

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {

struct Mean {
  static constexpr Card card{.name = "mean",
                             .title = "Mean",
                             .source = "[RV 3.4]",
                             .complexity = "O(n)",
                             .needs = {.accepts_missing = true}};
  explicit Mean(const Given& given);
  Estimate step(const Sample& y) const;
  Eigen::MatrixXd weights() const;

 private:
  Estimate of_present(const Sample& y) const;
  Eigen::VectorXd levels_;  // noise variances, empty: not known
  Eigen::Index channels_;
  double variance_;
};

}  // namespace libchar::fusion

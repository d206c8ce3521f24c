#pragma once
// x = (1/n) sum y_i: what every other algorithm is measured against. For several inputs, or gains
// that differ, ordinary least squares: X = (H'H)^-1 H' y.

#include <memory>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/variances/general_mean.hpp"

namespace libchar::fusion {

struct Mean {
  static constexpr Description description{
      .name = "mean",
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

}  // namespace libchar::fusion

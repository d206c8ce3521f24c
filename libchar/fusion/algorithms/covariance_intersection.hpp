#pragma once
// Fusion of sensors whose errors may be correlated in any way (Julier & Uhlmann 1997):
//   P^-1 = sum w_i h_i h_i' / v_i,  x = P sum w_i h_i y_i / v_i,  sum w = 1, w >= 0
// P is no less than the covariance of x whatever the correlations are, which inverse variances cannot say. w makes det
// P least, by the multiplicative algorithm w_i <- w_i h_i' P h_i / (r v_i) (Titterington 1978; Yu 2010). Of one input,
// seen alike by all, that is the sensor of the least noise level and no other: without knowing the correlation nothing
// better can be promised. fast = 1: w_i ~ 1/v_i (Niehsen 2002), an average whose P is larger.
// Of the samples that are there, w is scaled to one again: P holds for them too.

#include <array>
#include <memory>
#include <vector>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/variances/generalized_least_squares.hpp"

namespace libchar::fusion {

struct CovarianceIntersection {
  static constexpr Description description{
      .name = "covariance-intersection",
      .title = "Covariance intersection: errors correlated in any way",
      .source = "Julier & Uhlmann 1997",
      .complexity = "O(n r)",
      .needs = {.min_channels = 2, .noise_levels = true, .observation_matrix = true, .accepts_missing = true}};
  static constexpr std::array options{Option{"fast", "", 0, 0, 1, "1: shares as 1/v instead of the least bound", true}};
  CovarianceIntersection(const Array& array, const Settings& settings);
  Estimate step(const Sample& y);
  Eigen::MatrixXd weights() const { return mean_->weights(); }
  /// w of the channels.
  const Eigen::VectorXd& shares() const { return shares_; }

 private:
  Estimate best_present(const Sample& y) const;
  Eigen::VectorXd shares_, levels_;
  std::vector<Eigen::Index> order_;    // of one input: channels by noise level, best first
  std::unique_ptr<GeneralMean> mean_;  // with variances v / w
};

}  // namespace libchar::fusion

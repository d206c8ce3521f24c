#pragma once
// The weighted mean where channels see several inputs, or one with different gains: generalized
// least squares with variances that stay [RV 4.22, corrected: A = H]. Channels whose sample is
// missing are left out; the factors stand while the same channels are present.

#include <vector>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/variances/generalized_least_squares.hpp"

namespace libchar::fusion {

class GeneralMean {
 public:
  /// n rows of r inputs; a noise variance for each channel (all equal: ordinary least squares).
  GeneralMean(const Eigen::MatrixXd& h, const Eigen::VectorXd& variances);
  GeneralMean(const GeneralMean&) = delete;
  GeneralMean& operator=(const GeneralMean&) = delete;
  Estimate step(const Sample& y);
  /// n x r; zero for the channels that were missing in the last step.
  Eigen::MatrixXd weights() const;

 private:
  bool take_present(const Sample& y);

  GeneralizedLeastSquares gls_;
  Eigen::VectorXd variances_, residual_;
  std::vector<int> present_, before_;
  bool determined_ = false;
};

}  // namespace libchar::fusion

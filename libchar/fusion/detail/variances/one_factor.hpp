#pragma once
// C = g g' + D of n channels that see one input: gains g (in units of the input's deviation) and noise variances D on
// the diagonal, by alternating the leading eigenvector of D^-1/2 C D^-1/2 and D = diag(C - g g') (principal factor
// analysis, Lawley & Maxwell 1971). In memory of its own: no trip to the heap after construction.

#include <Eigen/Core>

namespace libchar::fusion {

class OneFactor {
 public:
  explicit OneFactor(Eigen::Index channels);
  /// From C = products / divisor (lower triangle). `known` variances of the noise, or empty: estimated,
  /// which needs three channels. Starts from the last solution. False: the channels share nothing,
  /// or some gain is not known to a tenth of itself from so many instants.
  bool solve(const Eigen::MatrixXd& products, double divisor, double instants, const Eigen::VectorXd& known);
  const Eigen::VectorXd& factor() const { return factor_; }  ///< g
  const Eigen::VectorXd& noise() const { return noise_; }    ///< D

 private:
  bool certain(double instants) const;
  Eigen::VectorXd factor_, noise_, scaled_, product_;
  bool begun_ = false;
};

}  // namespace libchar::fusion

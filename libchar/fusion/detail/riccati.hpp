#pragma once
// The discrete Riccati equation of a filter whose states are first order and whose input is not known:
//   P' = A P (I + G P)^-1 A' + Q,  A = diag(phi), Q = diag(drive), G = C' M C,
//   M = R^-1 - R^-1 H (H' R^-1 H)^-1 H' R^-1: what the samples tell beside any input
// 2^j steps at once have the same form (Anderson 1978; structured doubling, Chu, Fan, Lin 2005):
//   P_k+m = H_j + A_j' P_k (I + G_j P_k)^-1 A_j
//   A_j+1 = A_j (I + G_j H_j)^-1 A_j,  G_j+1 = G_j + A_j (I + G_j H_j)^-1 G_j A_j',
//   H_j+1 = H_j + A_j' H_j (I + G_j H_j)^-1 A_j;   H_j -> the steady state
// In the operators A is that of the transposed system.

#include <Eigen/Core>

namespace libchar::fusion {

class RiccatiSteps {
 public:
  RiccatiSteps(const Eigen::VectorXd& pole,
               const Eigen::VectorXd& drive,
               const Eigen::MatrixXd& information);
  /// Prediction covariance after as many steps as the operator stands for.
  Eigen::MatrixXd advance(const Eigen::MatrixXd& p) const;
  /// Twice as many steps.
  void twice();
  /// Doubles until nothing changes any more; then H is the steady state.
  const Eigen::MatrixXd& steady();

 private:
  Eigen::MatrixXd a_, g_, h_;
};

}  // namespace libchar::fusion

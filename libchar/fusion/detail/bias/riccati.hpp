#pragma once
// The discrete Riccati equation of a filter:
//   P' = F P (I + G P)^-1 F' + Q,  G = C' M C, M = R^-1, or beside an input H x that is not known
//   M = R^-1 - R^-1 H (H' R^-1 H)^-1 H' R^-1
// 2^j steps at once have the same form (Anderson 1978; structured doubling, Chu, Fan, Lin 2005):
//   P_k+m = H_j + A_j' P_k (I + G_j P_k)^-1 A_j
//   A_j+1 = A_j (I + G_j H_j)^-1 A_j,  G_j+1 = G_j + A_j (I + G_j H_j)^-1 G_j A_j',
//   H_j+1 = H_j + A_j' H_j (I + G_j H_j)^-1 A_j;   H_j -> the steady state
// In the operators A_0 = F', the transposed system.

#include <Eigen/Core>

namespace libchar::fusion {

class RiccatiSteps {
 public:
  RiccatiSteps(const Eigen::MatrixXd& transition, const Eigen::MatrixXd& drive, const Eigen::MatrixXd& information);
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

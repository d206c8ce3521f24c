#pragma once
// Dense algebra as Eigen has it, compiled once: the reference of tests and benches, apart from the
// library's own (core/dense.hpp).

#include <Eigen/Core>

namespace test {

Eigen::MatrixXd inverse(const Eigen::MatrixXd& a);         ///< LU
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& a);  ///< singular values
/// x with a x = b in the least squares' sense; QR.
Eigen::MatrixXd solution(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
/// U with U' U = a; Cholesky.
Eigen::MatrixXd upper_root(const Eigen::MatrixXd& a);
bool positive_definite(const Eigen::MatrixXd& a);

}  // namespace test

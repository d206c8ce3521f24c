#include "tests/support/algebra.hpp"

#include <Eigen/Dense>

namespace test {

Eigen::MatrixXd inverse(const Eigen::MatrixXd& a) { return a.inverse(); }

Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& a) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double least = svd.singularValues()[0] * 1e-15 * static_cast<double>(a.rows());
  const Eigen::VectorXd inverse = (svd.singularValues().array() > least).select(svd.singularValues().cwiseInverse(), 0);
  return svd.matrixV() * inverse.asDiagonal() * svd.matrixU().transpose();
}

Eigen::MatrixXd solution(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

Eigen::MatrixXd upper_root(const Eigen::MatrixXd& a) { return a.llt().matrixU(); }

bool positive_definite(const Eigen::MatrixXd& a) { return a.llt().info() == Eigen::Success; }

}  // namespace test

// Generalized least squares: known answers, with variances by batch MINQUE.

#include "libchar/fusion/detail/variances/generalized_least_squares.hpp"

#include <Eigen/Core>
#include <catch2/catch.hpp>
#include <numeric>

#include "tests/fusion/vectors.hpp"
#include "tests/support/algebra.hpp"

using namespace libchar::fusion;

namespace {

Eigen::MatrixXd matrix(const nlohmann::json& rows) {
  Eigen::MatrixXd m(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(rows[0].size()));
  for (Eigen::Index i = 0; i < m.rows(); ++i) m.row(i) = test::vector(rows[static_cast<std::size_t>(i)]).transpose();
  return m;
}
/// Noise variances by MINQUE with identity weights (Rao 1971): (P o P) v = diag(P C P), P = I - H (H'H)^-1 H'.
Eigen::VectorXd minque(const Eigen::MatrixXd& y, const Eigen::MatrixXd& h) {
  const Eigen::MatrixXd left = y - h * (test::inverse(h.transpose() * h) * (h.transpose() * y)),
                        p = Eigen::MatrixXd::Identity(h.rows(), h.rows()) -
                            h * test::inverse(h.transpose() * h) * h.transpose(),
                        centred = left.colwise() - left.rowwise().mean();
  return test::inverse(p.cwiseAbs2()) * centred.array().square().rowwise().mean().matrix();
}

}  // namespace

TEST_CASE("two inputs: variances, gain, estimates") {
  const auto answer = test::answers()["minque_r2"];
  const test::Vectors inputs("minque_r2_inputs.csv"), expected("minque_r2_gls.csv");
  const Eigen::MatrixXd h = matrix(answer["H"]), y = inputs.block("y", 6);
  const Eigen::VectorXd v = minque(y, h);
  CHECK(test::worst(v, test::vector(answer["sigma2"]), 2.6e-18, 1.25e-14) <= 1);
  GeneralizedLeastSquares gls(h);
  std::vector<int> all(6);
  std::iota(all.begin(), all.end(), 0);
  REQUIRE(gls.factor(v.data(), all.data(), 6));
  CHECK(test::worst(gls.gain(), matrix(answer["G"]), 1.78e-15, 3.52e-14) <= 1);
  Eigen::MatrixXd x(2, y.cols());
  Eigen::VectorXd residual(6);
  for (Eigen::Index k = 0; k < y.cols(); ++k) gls.solve(y.col(k).data(), x.col(k).data(), residual.data());
  CHECK(test::worst(x, expected.values.rightCols(2).transpose(), 1.78e-15, 3.52e-14) <= 1);
  // Variance of the inputs: diagonal of (H' R^-1 H)^-1.
  const Eigen::Matrix2d variances = test::inverse(h.transpose() * v.cwiseInverse().asDiagonal() * h);
  CHECK(gls.variance(0) == Approx(variances(0, 0)));
  CHECK(gls.variance(1) == Approx(variances(1, 1)));
}

TEST_CASE("generalized least squares refuses channels that do not determine the inputs") {
  GeneralizedLeastSquares gls((Eigen::MatrixXd(3, 2) << 1, 2, 2, 4, 1, 0).finished());
  const std::vector<double> v{1, 1, 1};
  const std::vector<int> all{0, 1, 2}, dependent{0, 1};
  CHECK(gls.factor(v.data(), all.data(), 3));
  CHECK_FALSE(gls.factor(v.data(), dependent.data(), 2));
  CHECK_FALSE(gls.factor(v.data(), all.data(), 1));
}

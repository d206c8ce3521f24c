// Batch MINQUE and REML, generalized least squares, identifiability: known answers.

#include "libchar/fusion/detail/minque_batch.hpp"

#include <Eigen/Core>
#include <catch2/catch.hpp>
#include <numeric>

#include "libchar/fusion/detail/generalized_least_squares.hpp"
#include "tests/fusion/vectors.hpp"
#include "tests/support/algebra.hpp"

using namespace libchar::fusion;

namespace {

Eigen::MatrixXd matrix(const nlohmann::json& rows) {
  Eigen::MatrixXd m(static_cast<Eigen::Index>(rows.size()),
                    static_cast<Eigen::Index>(rows[0].size()));
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    m.row(i) = test::vector(rows[static_cast<std::size_t>(i)]).transpose();
  return m;
}
Eigen::MatrixXd covariance(const Eigen::MatrixXd& y) {
  const Eigen::MatrixXd centred = y.colwise() - y.rowwise().mean();
  return centred * centred.transpose() / static_cast<double>(y.cols());
}

}  // namespace

TEST_CASE("MINQUE and REML of a record") {
  const auto answers = test::answers();
  const test::Vectors inputs("fusion_inputs.csv");
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(5, 1),
                        c = covariance(residuals(inputs.block("c", 5), one));
  CHECK(test::worst(
            c.diagonal(), test::vector(answers["minque_batch"]["varPY"]), 4.44e-16, 1.2e-15) <= 1);
  CHECK(test::worst(
            minque(c, one), test::vector(answers["minque_batch"]["sigma2"]), 4.44e-16, 1.2e-15) <=
        1);
  CHECK(test::worst(minque(Eigen::VectorXd(c.diagonal())),
                    test::vector(answers["minque_batch"]["sigma2"]),
                    4.44e-16,
                    1.2e-15) <= 1);
  CHECK(test::worst(
            reml(c, one), test::vector(answers["reml_batch"]["sigma2"]), 2.66e-15, 7.19e-15) <= 1);
}

TEST_CASE("two inputs: variances, gain, estimates") {
  const auto answer = test::answers()["minque_r2"];
  const test::Vectors inputs("minque_r2_inputs.csv"), expected("minque_r2_gls.csv");
  const Eigen::MatrixXd h = matrix(answer["H"]), y = inputs.block("y", 6);
  const Eigen::VectorXd v = minque(covariance(residuals(y, h)), h);
  CHECK(test::worst(v, test::vector(answer["sigma2"]), 2.6e-18, 1.25e-14) <= 1);
  GeneralizedLeastSquares gls(h);
  std::vector<int> all(6);
  std::iota(all.begin(), all.end(), 0);
  REQUIRE(gls.factor(v.data(), all.data(), 6));
  CHECK(test::worst(gls.gain(), matrix(answer["G"]), 1.78e-15, 3.52e-14) <= 1);
  Eigen::MatrixXd x(2, y.cols());
  Eigen::VectorXd residual(6);
  for (Eigen::Index k = 0; k < y.cols(); ++k)
    gls.solve(y.col(k).data(), x.col(k).data(), residual.data());
  CHECK(test::worst(x, expected.values.rightCols(2).transpose(), 1.78e-15, 3.52e-14) <= 1);
  // Variance of the inputs: diagonal of (H' R^-1 H)^-1.
  const Eigen::Matrix2d variances =
      test::inverse(h.transpose() * v.cwiseInverse().asDiagonal() * h);
  CHECK(gls.variance(0) == Approx(variances(0, 0)));
  CHECK(gls.variance(1) == Approx(variances(1, 1)));
}

TEST_CASE("which variances the differences of the channels determine") {
  CHECK(not_identifiable(Eigen::MatrixXd::Ones(3, 1)).empty());
  CHECK(not_identifiable(Eigen::MatrixXd::Ones(2, 1)) ==
        "the noise variances of 2 channels of 1 input cannot be told apart: their differences give "
        "1 second moments for 2 "
        "variances");
  // r = 3 with n = 6 works, though 2r < n is not met; the block H of r = 2, n = 5
  // does not.
  const Eigen::MatrixXd general = (Eigen::MatrixXd(6, 3) << 1,
                                   .3,
                                   -.2,
                                   .1,
                                   1,
                                   .4,
                                   -.5,
                                   .2,
                                   1,
                                   .7,
                                   -.6,
                                   .1,
                                   .3,
                                   .8,
                                   -.9,
                                   -.4,
                                   .1,
                                   .6)
                                      .finished();
  CHECK(not_identifiable(general).empty());
  const Eigen::MatrixXd block = (Eigen::MatrixXd(5, 2) << 1, 0, 1, 0, 1, 0, 0, 1, 0, 1).finished();
  CHECK(not_identifiable(block) ==
        "the noise variances of 5 channels of 2 inputs cannot be told apart: this observation "
        "matrix mixes those of channels 4, 5");
  CHECK_THROWS(minque(Eigen::MatrixXd(Eigen::MatrixXd::Identity(5, 5)), block));
  CHECK_THROWS(reml(Eigen::MatrixXd(Eigen::MatrixXd::Identity(5, 5)), block));
}

TEST_CASE("generalized least squares refuses channels that do not determine the inputs") {
  GeneralizedLeastSquares gls((Eigen::MatrixXd(3, 2) << 1, 2, 2, 4, 1, 0).finished());
  const std::vector<double> v{1, 1, 1};
  const std::vector<int> all{0, 1, 2}, dependent{0, 1};
  CHECK(gls.factor(v.data(), all.data(), 3));
  CHECK_FALSE(gls.factor(v.data(), dependent.data(), 2));
  CHECK_FALSE(gls.factor(v.data(), all.data(), 1));
}

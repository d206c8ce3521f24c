// Covariance intersection: shares of the least bound, and the bound for errors correlated in any way.

#include "libchar/fusion/algorithms/covariance_intersection.hpp"

#include <Eigen/Core>
#include <catch2/catch.hpp>

#include "tests/fusion/vectors.hpp"
#include "tests/support/algebra.hpp"
#include "tests/support/noise.hpp"

using namespace libchar::fusion;

namespace {

Array three_rows() {
  Array array = test::array(3);
  array.observation_matrix = (Eigen::MatrixXd(3, 2) << 1, 0, 0, 1, 1, 1).finished();
  array.noise_levels = Eigen::Vector3d(1, 1, 1);
  return array;
}

}  // namespace

TEST_CASE("covariance-intersection: of one input it is the sensor of the least noise") {
  Array array = test::array(3);
  array.noise_levels = Eigen::Vector3d(3, 1, 2);
  auto fusion = test::make("covariance-intersection", array);
  Eigen::MatrixXd y(3, 3);
  y << 1, 4, 7, 2, std::nan(""), std::nan(""), 3, 6, std::nan("");
  const test::Run run = test::run(*fusion, y);
  CHECK(run.x == Eigen::RowVector3d(2, 6, 7));
  CHECK(run.variance == Eigen::RowVector3d(1, 2, 3));
  // Niehsen: shares 1/v, P = sum 1/v / sum 1/v^2.
  auto fast = test::make("covariance-intersection", array, {{"fast", 1}});
  const test::Run averaged = test::run(*fast, y.leftCols(1));
  CHECK(averaged.variance(0, 0) == Approx((1.0 / 3 + 1 + 0.5) / (1.0 / 9 + 1 + 0.25)).epsilon(1e-12));
  CHECK(averaged.x(0, 0) == Approx((1.0 / 9 + 2 + 3 * 0.25) / (1.0 / 9 + 1 + 0.25)).epsilon(1e-12));
}

TEST_CASE("covariance-intersection: shares of the least determinant") {
  // Three rows of two inputs that are alike up to a turn of the inputs: a third each.
  const CovarianceIntersection alike(three_rows(), test::settings("covariance-intersection", {}));
  CHECK((alike.shares() - Eigen::Vector3d::Constant(1.0 / 3)).cwiseAbs().maxCoeff() < 1e-6);
  // Kiefer & Wolfowitz: at the least determinant h'Ph/v is r where the share is above zero, else less.
  test::Gaussian gauss(3);
  Array array = test::array(7);
  array.observation_matrix.resize(7, 3);
  for (double& v : array.observation_matrix.reshaped()) v = gauss();
  array.noise_levels = Eigen::VectorXd::LinSpaced(7, 1, 4);
  const CovarianceIntersection fusion(array, test::settings("covariance-intersection", {}));
  const Eigen::MatrixXd& h = array.observation_matrix;
  const Eigen::VectorXd information = fusion.shares().cwiseQuotient(array.noise_levels);
  const Eigen::MatrixXd p = test::inverse(h.transpose() * information.asDiagonal() * h);
  for (Eigen::Index i = 0; i < 7; ++i) {
    const double leverage = h.row(i).dot(p * h.row(i).transpose()) / array.noise_levels[i];
    CHECK(leverage < 3 * (1 + 1e-3));
    if (fusion.shares()[i] > 1e-3) CHECK(leverage == Approx(3).epsilon(1e-3));
  }
}

TEST_CASE("covariance-intersection: what it states holds for any correlation, inverse variances do not") {
  test::Gaussian gauss(4);
  const Array array = three_rows();
  for (const double correlation : {-0.45, 0.0, 0.5, 0.95}) {
    INFO(correlation);
    Eigen::Matrix3d s = Eigen::Matrix3d::Constant(correlation);
    s.diagonal().setOnes();
    for (const char* name : {"covariance-intersection", "inverse-variance"}) {
      auto fusion = test::make(name, array);
      const test::Run run = test::run(*fusion, Eigen::MatrixXd::Zero(3, 1), 2);
      const Eigen::MatrixXd w = *fusion->weights();
      const Eigen::MatrixXd actual = w.transpose() * s * w;
      if (std::string(name) == "covariance-intersection")
        for (Eigen::Index j = 0; j < 2; ++j) CHECK(actual(j, j) <= run.variance(j, 0) * (1 + 1e-9));
      else if (correlation == -0.45)
        CHECK(actual(0, 0) > 1.1 * run.variance(0, 0));
    }
  }
}

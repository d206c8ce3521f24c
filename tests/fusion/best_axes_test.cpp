// The choice of axes against all choices there are, and the estimates of those chosen.
#include "libchar/fusion/algorithms/best_axes.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "libchar/core/error.hpp"
#include "tests/fusion/scenes.hpp"
#include "tests/fusion/vectors.hpp"
#include "tests/support/algebra.hpp"
#include "tests/support/noise.hpp"

using namespace libchar::fusion;

namespace {

/// Least trace of all sets of three.
double least_of_all(const Eigen::MatrixXd& h, const Eigen::VectorXd& d) {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index a = 0; a < h.rows(); ++a)
    for (Eigen::Index b = a + 1; b < h.rows(); ++b)
      for (Eigen::Index c = b + 1; c < h.rows(); ++c) {
        const std::vector<Eigen::Index> set{a, b, c};
        const Eigen::MatrixXd inverse = test::inverse(h(set, Eigen::indexing::all));
        const double trace = (inverse * d(set).asDiagonal() * inverse.transpose()).trace();
        if (trace < least) least = trace;
      }
  return least;
}

/// Triads a little out of line, rows x, y, z of each.
Eigen::MatrixXd triads(Eigen::Index count, test::Gaussian& gauss) {
  Eigen::MatrixXd h(3 * count, 3);
  for (Eigen::Index i = 0; i < h.rows(); ++i)
    for (Eigen::Index j = 0; j < 3; ++j) h(i, j) = (i % 3 == j ? 1 : 0) + 0.05 * gauss();
  return h;
}

}  // namespace

TEST_CASE("best-axes: one of each axis from triads, the best of all sets") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    test::Gaussian gauss(seed);
    const Eigen::MatrixXd h = triads(5, gauss);
    Eigen::VectorXd d(h.rows());
    for (double& value : d) value = std::exp(gauss());
    const ChosenAxes chosen = choose_axes(h, d);
    REQUIRE(chosen.determined);
    CHECK(chosen.variance.sum() == Approx(least_of_all(h, d)).epsilon(1e-9));
  }
}

TEST_CASE("best-axes: any directions, nearly always the best of all sets and never far from it") {
  int best = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    test::Gaussian gauss(seed);
    Eigen::MatrixXd h(9, 3);
    Eigen::VectorXd d(9);
    for (double& value : h.reshaped()) value = gauss();
    for (double& value : d) value = std::exp(gauss());
    const double ours = choose_axes(h, d).variance.sum(), least = least_of_all(h, d);
    CHECK(ours < 1.5 * least);
    best += ours < 1.000001 * least ? 1 : 0;
  }
  CHECK(best >= 90);
}

TEST_CASE("best-axes: what it learns, and what it does without the best") {
  test::Gaussian gauss(3);
  const Eigen::MatrixXd h = triads(4, gauss);
  Array array = test::array(12);
  array.observation_matrix = h;
  array.learning_samples = 2000;
  Eigen::VectorXd sigma = Eigen::VectorXd::Constant(12, 1);
  sigma[4] = sigma[6] = sigma[11] = 0.1;  // y of the second, x of the third, z of the fourth
  Eigen::MatrixXd y(12, 4000), truth(3, 4000);
  for (Eigen::Index k = 0; k < y.cols(); ++k) {
    for (double& value : truth.col(k)) value = 5 * gauss();
    y.col(k) = h * truth.col(k);
    for (Eigen::Index i = 0; i < 12; ++i) y(i, k) += sigma[i] * gauss();
  }
  auto runner = test::make("best-axes", array);
  runner->learn(y.leftCols(2000), truth.leftCols(2000));
  runner->finish_learning();
  const test::Run run = test::run(*runner, y, 3);
  const Eigen::MatrixXd error = (run.x - truth).rightCols(2000);
  for (Eigen::Index j = 0; j < 3; ++j) {
    CHECK(error.row(j).norm() / std::sqrt(2000.0) == Approx(0.1).epsilon(0.1));
    CHECK(run.variance(j, 3000) == Approx(0.01).epsilon(0.25));
  }
  const Eigen::MatrixXd weights = *runner->weights();
  CHECK((weights.array() != 0).rowwise().any().count() == 3);
  CHECK((weights.transpose() * h - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-12);
  // The best z is gone: another takes its place, and the others stay.
  Eigen::MatrixXd without = y.rightCols(100);
  without.row(11).setConstant(test::kNaN);
  const test::Run less = test::run(*runner, without, 3);
  CHECK(less.variance(0, 0) == Approx(0.01).epsilon(0.25));
  CHECK(less.variance(2, 0) == Approx(1).epsilon(0.1));
  // No z at all.
  without.row(2).setConstant(test::kNaN);
  without.row(5).setConstant(test::kNaN);
  without.row(8).setConstant(test::kNaN);
  const test::Run none = test::run(*runner, without, 3);
  CHECK(none.variance(2, 0) > 10);  // out of what the others see of it
  const test::Run again = test::run(*runner, y, 3);
  CHECK(test::same_values(again.x, run.x));
}

TEST_CASE("best-axes: channels that were never seen, or that do not determine the inputs") {
  Array array = test::array(3);
  array.observation_matrix.resize(3, 2);
  array.learning_samples = 10;
  array.observation_matrix << 1, 0, 2, 0, 0, 1;
  Eigen::MatrixXd y(3, 10), truth(2, 10);
  for (Eigen::Index k = 0; k < 10; ++k) {
    truth.col(k) << 1.0 * static_cast<double>(k), -2;
    y.col(k) << truth(0, k) + 0.1, 2 * truth(0, k) - 0.1, test::kNaN;
  }
  auto runner = test::make("best-axes", array);
  runner->learn(y, truth);
  CHECK_THROWS_AS(runner->finish_learning(), libchar::Error);
  y.row(2).setConstant(-2);  // without any error
  auto determined = test::make("best-axes", array);
  determined->learn(y, truth);
  determined->finish_learning();
  const test::Run run = test::run(*determined, y, 2);
  CHECK(run.x(0, 5) == Approx(4.95));  // half of the second's error
  CHECK(run.x(1, 5) == -2);
}

TEST_CASE("best-axes: the best channels on one axis do not stand for the others") {
  Eigen::MatrixXd h(5, 3);
  h << 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  const Eigen::VectorXd d = (Eigen::VectorXd(5) << 1e-6, 1e-6, 2e-6, 1, 4).finished();
  const ChosenAxes chosen = choose_axes(h, d);
  REQUIRE(chosen.determined);
  CHECK(chosen.variance[0] == Approx(1e-6));
  CHECK(chosen.variance[1] == Approx(1));
  CHECK(chosen.variance[2] == Approx(4));
}

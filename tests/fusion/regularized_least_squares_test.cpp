// Least squares on a shrunk covariance and with weights of at least zero: closed forms, the conditions of
// the optimum, and what they are for.

#include <Eigen/Core>
#include <catch2/catch.hpp>

#include "libchar/fusion/algorithms/least_squares.hpp"
#include "libchar/fusion/detail/variances/error_weights.hpp"
#include "tests/fusion/vectors.hpp"
#include "tests/support/algebra.hpp"
#include "tests/support/noise.hpp"

using namespace libchar::fusion;

namespace {

/// Columns whose second moments are exactly S.
Eigen::MatrixXd errors_of(const Eigen::MatrixXd& s) { return test::upper_root(s); }

Eigen::VectorXd optimum(const Eigen::MatrixXd& s) {
  const Eigen::VectorXd v = test::solution(s, Eigen::VectorXd::Ones(s.rows()));
  return v / v.sum();
}

Eigen::MatrixXd random_covariance(test::Gaussian& gauss, Eigen::Index n) {
  Eigen::MatrixXd a(n, n + 2);
  for (double& v : a.reshaped()) v = gauss();
  const Eigen::VectorXd size = Eigen::VectorXd::LinSpaced(n, 0.01, 10);
  return size.asDiagonal() * (a * a.transpose()) * size.asDiagonal();
}

/// Weights that a learner finds for errors with exactly these second moments.
LearntWeights learn(const Eigen::MatrixXd& error, const LeastSquaresForm& form) {
  WeightLearner learner(error.cols());
  for (Eigen::Index k = 0; k < error.rows(); ++k) {
    const double x = static_cast<double>(k % 7);
    const Eigen::VectorXd y = error.row(k).transpose().array() + x;
    learner.add(Sample(y.data(), y.size()), x);
  }
  return learner.weights(form);
}

}  // namespace

TEST_CASE("non-negative weights: three channels, by hand") {
  // cov(1, 2) = 1.8 > v1 = 1: the free optimum has a weight below zero for channel 2.
  Eigen::Matrix3d s;
  s << 1, 1.8, 0, 1.8, 4, 0, 0, 0, 2;
  REQUIRE(optimum(s)[1] < 0);
  const Eigen::VectorXd w = non_negative_weights(errors_of(s));
  CHECK(w[0] == Approx(2.0 / 3).epsilon(1e-13));
  CHECK(w[1] == 0);
  CHECK(w[2] == Approx(1.0 / 3).epsilon(1e-13));
}

TEST_CASE("non-negative weights: the conditions of Karush, Kuhn and Tucker hold") {
  test::Gaussian gauss(7);
  int at_zero = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::MatrixXd s = random_covariance(gauss, 2 + trial % 9);
    const Eigen::VectorXd w = non_negative_weights(errors_of(s));
    CHECK(w.minCoeff() >= 0);
    CHECK(w.sum() == Approx(1).epsilon(1e-14));
    const Eigen::VectorXd slope = s * w;
    const double level = w.dot(slope);
    for (Eigen::Index i = 0; i < w.size(); ++i) {
      CHECK(slope[i] >= level * (1 - 1e-9));
      if (w[i] > 0) CHECK(slope[i] == Approx(level).epsilon(1e-9));
      at_zero += w[i] == 0;
    }
  }
  CHECK(at_zero > 100);
}

TEST_CASE("non-negative weights: no errors, equal errors, one channel") {
  CHECK(non_negative_weights(Eigen::MatrixXd::Zero(4, 3)) == Eigen::Vector3d::Constant(1.0 / 3));
  CHECK(non_negative_weights(Eigen::MatrixXd::Ones(4, 1))[0] == 1);
  const Eigen::VectorXd alike = non_negative_weights(Eigen::MatrixXd::Ones(4, 3));
  CHECK(alike.sum() == Approx(1));
  CHECK(alike.minCoeff() >= 0);
}

TEST_CASE("shrunk least squares: the optimum of (1 - s) S + s diag S") {
  test::Gaussian gauss(8);
  for (const double share : {0.1, 0.5, 1.0}) {
    Eigen::MatrixXd error(400, 4);
    for (Eigen::Index k = 0; k < error.rows(); ++k) {
      const double common = gauss();
      for (Eigen::Index i = 0; i < 4; ++i) error(k, i) = 0.3 * static_cast<double>(i + 1) * (common + 0.5 * gauss());
    }
    const Eigen::MatrixXd s = error.transpose() * error;
    const Eigen::MatrixXd target = s.diagonal().asDiagonal();
    const LearntWeights learnt = learn(error, {.shrinkage = share});
    CHECK((learnt.weights - optimum((1 - share) * s + share * target)).cwiseAbs().maxCoeff() < 1e-11);
    CHECK(learnt.variance == Approx((error * learnt.weights).squaredNorm() / 397).epsilon(1e-10));
  }
}

TEST_CASE("shrunk least squares: independent errors are shrunk, correlated ones are not") {
  test::Gaussian gauss(9);
  Eigen::MatrixXd alone(300, 5), together(300, 5);
  for (Eigen::Index k = 0; k < 300; ++k) {
    const double common = gauss();
    for (Eigen::Index i = 0; i < 5; ++i) {
      alone(k, i) = gauss();
      together(k, i) = common + 0.3 * gauss();
    }
  }
  CHECK(estimated_shrinkage(alone, 300) > 0.5);
  CHECK(estimated_shrinkage(together, 300) < 0.01);
}

TEST_CASE("regularized least squares: a short window makes no extreme weights") {
  // Errors share a drift; 12 instants to learn 6 weights from. Averaged over windows, free weights do
  // worse on a new record than shrunk or non-negative ones.
  test::Gaussian gauss(10);
  double free = 0, shrunk = 0, positive = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const auto record = [&](Eigen::Index rows) {
      Eigen::MatrixXd error(rows, 6);
      for (Eigen::Index k = 0; k < rows; ++k) {
        const double drift = gauss();
        for (Eigen::Index i = 0; i < 6; ++i) error(k, i) = 0.5 * drift + (0.5 + 0.2 * static_cast<double>(i)) * gauss();
      }
      return error;
    };
    const Eigen::MatrixXd window = record(12), rest = record(500);
    const auto square = [&](const LeastSquaresForm& form) {
      return (rest * learn(window, form).weights).squaredNorm() / 500;
    };
    free += square({});
    shrunk += square({.shrinkage = 0.1});
    positive += square({.non_negative = true});
  }
  CHECK(shrunk < 0.95 * free);
  CHECK(positive < 0.8 * free);
}

// Mean, inverse-variance and median against fixtures/known/fusion and by hand.

#include <Eigen/Core>
#include <catch2/catch.hpp>

#include "libchar/fusion/algorithms/averages.hpp"
#include "tests/fusion/vectors.hpp"
#include "tests/support/algebra.hpp"

using namespace libchar::fusion;

TEST_CASE("mean: 50-digit vectors") {
  const test::Vectors inputs("fusion_inputs.csv"), expected("average.csv");
  auto mean = test::make("mean", test::array(5));
  CHECK(test::worst(test::run(*mean, inputs.block("c", 5)).x, expected["avg_calibrated"].transpose(), 1.78e-15) <= 1);
  CHECK(test::worst(test::run(*mean, inputs.block("u", 5)).x, expected["avg_uncalibrated"].transpose(), 1.78e-15) <= 1);
}

TEST_CASE("inverse-variance: weights and error of the known answers") {
  const auto answer = test::answers()["weighted_average"];
  const test::Vectors inputs("fusion_inputs.csv");
  Array array = test::array(5);
  array.noise_levels.resize(5);
  Eigen::VectorXd weights(5);
  for (Eigen::Index i = 0; i < 5; ++i) {
    array.noise_levels[i] = answer["variances"][static_cast<std::size_t>(i)];
    weights[i] = answer["weights"][static_cast<std::size_t>(i)];
  }
  auto fusion = test::make("inverse-variance", array);
  CHECK(test::worst(*fusion->weights(), weights, 1e-16) <= 1);
  const Eigen::VectorXd error = test::run(*fusion, inputs.block("c", 5)).x.transpose() - inputs["x"];
  CHECK(std::sqrt(error.squaredNorm() / 2000) == Approx(answer["rms_1_2000"].get<double>()).epsilon(1e-13));
}

TEST_CASE("inverse-variance: noise levels near the ends of a double are levels like any others") {
  for (const double level : {1e-309, 1e-200, 1e200, 4e307}) {
    Array array = test::array(2);
    array.noise_levels = Eigen::Vector2d(level, 4 * level);
    const test::Run run = test::run(*test::make("inverse-variance", array), Eigen::Vector2d(10, 20));
    CAPTURE(level);
    CHECK(run.x(0, 0) == Approx(12).epsilon(1e-12));
    CHECK(run.variance(0, 0) == Approx(0.8 * level).epsilon(1e-6));
  }
}

TEST_CASE("missing samples: the others take over") {
  const double gap = std::nan("");
  Eigen::MatrixXd y(3, 4);
  y << 1, gap, gap, 7,  //
      2, 4, gap, gap,   //
      6, 8, gap, gap;
  Array array = test::array(3);
  array.noise_levels = Eigen::Vector3d(1, 1, 2);
  struct Case {
    std::string name;
    std::array<double, 3> x, variance;
  };
  for (const Case& c :
       {Case{"mean", {3, 6, 7}, {4.0 / 9, 3.0 / 4, 1}}, Case{"inverse-variance", {2.4, 16.0 / 3, 7}, {0.4, 2.0 / 3, 1}},
        Case{"median", {2, 6, 7}, {gap, gap, gap}}}) {
    INFO(c.name);
    auto runner = test::make(c.name, array);
    const test::Run out = test::run(*runner, y);
    CHECK(out.x(0, 0) == Approx(c.x[0]));
    CHECK(out.x(0, 1) == Approx(c.x[1]));
    CHECK(std::isnan(out.x(0, 2)));
    CHECK(out.x(0, 3) == Approx(c.x[2]));
    if (c.name == "median") continue;
    CHECK(out.variance(0, 0) == Approx(c.variance[0]));
    CHECK(out.variance(0, 1) == Approx(c.variance[1]));
    CHECK(out.variance(0, 3) == Approx(c.variance[2]));
  }
}

TEST_CASE("median: even and odd, few and many, against sorting") {
  for (const Eigen::Index n : {1, 2, 3, 4, 5, 23, 24, 25, 26, 200}) {
    Eigen::MatrixXd y(n, 5);
    std::uint64_t state = 7;
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      state = state * 6364136223846793005U + 1442695040888963407U;
      y.data()[i] = static_cast<double>(state >> 40U);
    }
    auto median = test::make("median", test::array(n));
    const test::Run out = test::run(*median, y);
    for (Eigen::Index k = 0; k < y.cols(); ++k) {
      std::vector<double> sorted(y.col(k).data(), y.col(k).data() + n);
      std::sort(sorted.begin(), sorted.end());
      const std::size_t half = sorted.size() / 2;
      CHECK(out.x(0, k) == (n % 2 == 1 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2));
    }
  }
}

TEST_CASE("mean and inverse variance of several inputs are least squares", "[fusion]") {
  Array array;
  array.channels = 5;
  array.observation_matrix.resize(5, 2);
  array.observation_matrix << 1, -0.2, 1, -0.1, 1, 0, 1, 0.15, 2, 0.3;
  array.noise_levels = Eigen::VectorXd::LinSpaced(5, 0.1, 2);
  Eigen::VectorXd y(5);
  y << 0.3, -1, 2, 0.7, 5;
  const auto expected = [&](const Eigen::VectorXd& w, const std::vector<Eigen::Index>& rows) {
    const Eigen::MatrixXd h = array.observation_matrix(rows, Eigen::indexing::all);
    const Eigen::MatrixXd hw = h.transpose() * Eigen::VectorXd(w(rows)).asDiagonal();
    return Eigen::VectorXd(test::solution(hw * h, hw * y(rows)));
  };
  const std::vector<Eigen::Index> all = {0, 1, 2, 3, 4}, some = {0, 2, 4};
  const auto check = [&](auto& algorithm, const Eigen::VectorXd& w) {
    const Eigen::VectorXd samples = y;
    const Estimate whole = algorithm.step(Sample(samples.data(), 5));
    CHECK((whole.x - expected(w, all)).norm() < 1e-13);
    CHECK((algorithm.weights().transpose() * y - whole.x).norm() < 1e-13);
    Eigen::VectorXd gaps = y;
    gaps[1] = gaps[3] = std::nan("");
    CHECK((algorithm.step(Sample(gaps.data(), 5)).x - expected(w, some)).norm() < 1e-13);
    gaps.setConstant(std::nan(""));
    gaps[2] = 1;
    CHECK(std::isnan(algorithm.step(Sample(gaps.data(), 5)).x[0]));
    CHECK((algorithm.step(Sample(samples.data(), 5)).x - whole.x).norm() == 0);
  };
  Mean mean(array);
  check(mean, Eigen::VectorXd::Ones(5));
  InverseVariance weighted(array);
  check(weighted, array.noise_levels.cwiseInverse());
}

TEST_CASE("inverse-variance: no estimate has no variance either") {
  libchar::fusion::Array array;
  array.channels = 2;
  array.noise_levels = Eigen::Vector2d(1, 4);
  const libchar::fusion::InverseVariance algorithm(array);
  const Eigen::Vector2d none(std::nan(""), std::nan(""));
  const auto estimate = algorithm.step(libchar::fusion::Sample(none.data(), 2));
  CHECK(std::isnan(estimate.x[0]));
  CHECK(std::isnan(estimate.variance[0]));
}

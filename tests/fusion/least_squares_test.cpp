// Least squares: calibration and weights of the known answers; bounds.

#include "libchar/fusion/algorithms/least_squares.hpp"

#include <catch2/catch.hpp>
#include <functional>

#include "libchar/core/error.hpp"
#include "libchar/fusion/algorithms/bounds.hpp"
#include "tests/fusion/vectors.hpp"
#include "tests/support/noise.hpp"

using namespace libchar::fusion;

namespace {

double rms_501_2000(const std::string& name, const test::Values& options, const Eigen::MatrixXd& y,
                    const Eigen::VectorXd& x) {
  Array array = test::array(y.rows());
  array.learning_samples = 500;
  auto fusion = test::make(name, array, options);
  fusion->learn(y.leftCols(500), x.head(500).transpose());
  fusion->finish_learning();
  const Eigen::VectorXd error = test::run(*fusion, y.rightCols(1500)).x.transpose() - x.tail(1500);
  return std::sqrt(error.squaredNorm() / 1500);
}

}  // namespace

TEST_CASE("least squares: calibration and weights of the known answers") {
  const auto answer = test::answers()["lsq"];
  const test::Vectors inputs("fusion_inputs.csv");
  const Eigen::MatrixXd u = inputs.block("u", 5), c = inputs.block("c", 5);
  const Eigen::VectorXd x = inputs["x"];
  WeightLearner of_u(5), of_c(5);
  for (Eigen::Index k = 0; k < 500; ++k) {
    of_u.add(Sample(u.col(k).data(), 5), x[k]);
    of_c.add(Sample(c.col(k).data(), 5), x[k]);
  }
  const LearntWeights corrected = of_u.weights({.calibrate = true, .sum_to_one = false});
  CHECK(test::worst(corrected.gain, test::vector(answer["a"]), 1.11e-15, 1.19e-15) <= 1);
  CHECK(test::worst(corrected.bias, test::vector(answer["b"]), 5.55e-17, 1.64e-16) <= 1);
  CHECK(test::worst(corrected.weights, test::vector(answer["w_uncal_corrected"]), 6.84e-16, 1.44e-13) <= 1);
  CHECK(test::worst(of_c.weights({.sum_to_one = false}).weights, test::vector(answer["w_cal"]), 4.44e-16, 1.04e-13) <=
        1);
  CHECK(test::worst(of_c.weights({.sum_to_one = true}).weights, test::vector(answer["w_cal_sum1"]), 4.44e-16,
                    1.69e-15) <= 1);
  const LearntWeights affine = of_u.weights({.sum_to_one = false, .constant = true});
  const Eigen::VectorXd expected = test::vector(answer["w_affine_uncal_then_const"]);
  CHECK(test::worst(affine.weights, expected.head(5), 6.84e-16, 1.44e-13) <= 1);
  CHECK(affine.constant == Approx(expected[5]).epsilon(1e-12));

  const auto& rms = answer["rms_501_2000"];
  CHECK(rms_501_2000("least-squares-published", {}, u, x) == Approx(rms["uncal"].get<double>()).epsilon(1e-12));
  CHECK(rms_501_2000("least-squares-published", {{"calibrate", 0}}, c, x) ==
        Approx(rms["cal"].get<double>()).epsilon(1e-12));
  CHECK(rms_501_2000("least-squares", {{"calibrate", 0}}, c, x) ==
        Approx(rms["cal_sum1"].get<double>()).epsilon(1e-12));
  CHECK(rms_501_2000("least-squares-published", {{"calibrate", 0}, {"constant", 1}}, u, x) ==
        Approx(rms["affine"].get<double>()).epsilon(1e-12));
}

TEST_CASE("least squares: weights survive an input 1e8 times the noise") {
  test::Gaussian gauss(3);
  const Eigen::Vector3d deviations(1, 2, 3);
  WeightLearner small(3), large(3);
  for (int k = 0; k < 4000; ++k) {
    const double unit = gauss();
    Eigen::Vector3d noise;
    for (Eigen::Index i = 0; i < 3; ++i) noise[i] = deviations[i] * gauss();
    const Eigen::Vector3d a = noise.array() + unit, b = noise.array() + 1e8 * unit;
    small.add(Sample(a.data(), 3), unit);
    large.add(Sample(b.data(), 3), 1e8 * unit);
  }
  const LeastSquaresForm form{.calibrate = false, .sum_to_one = true};
  CHECK((small.weights(form).weights - large.weights(form).weights).cwiseAbs().maxCoeff() < 1e-7);
}

TEST_CASE("least squares: what cannot be learnt is said") {
  Array array = test::array(2);
  array.learning_samples = 100;
  Eigen::MatrixXd y = Eigen::MatrixXd::Random(2, 100), x = Eigen::MatrixXd::Ones(1, 100);
  {
    auto still = test::make("least-squares", array);
    still->learn(y, x);
    CHECK_THROWS_AS(still->finish_learning(), libchar::Error);
  }
  {
    auto few = test::make("least-squares", array);
    few->learn(y.leftCols(3), Eigen::MatrixXd::Random(1, 3));
    CHECK_THROWS_AS(few->finish_learning(), libchar::Error);
  }
  {  // a dead channel is left out
    auto dead = test::make("least-squares", array);
    x = Eigen::MatrixXd::Random(1, 100);
    y.row(0) = x + 0.01 * y.row(0);
    y.row(1).setConstant(3);
    dead->learn(y, x);
    dead->finish_learning();
    CHECK((*dead->weights())(1, 0) == 0);
    CHECK((*dead->weights())(0, 0) == 1);
    libchar::Findings warnings;
    dead->remarks(warnings);
    CHECK(warnings.find("channel_without_signal") != nullptr);
  }
}

TEST_CASE("bounds: best channel, optimal weights, sections") {
  test::Gaussian gauss(8);
  Eigen::MatrixXd y(3, 6000), x(1, 6000);
  for (Eigen::Index k = 0; k < y.cols(); ++k) {
    x(0, k) = 5 * gauss();
    for (Eigen::Index i = 0; i < 3; ++i) y(i, k) = x(0, k) + (i == 1 ? 1 : 2) * gauss();
    if (k >= 3000) y(1, k) = 0;  // the best one dies
  }
  Array array = test::array(3);
  array.reference_throughout = true;
  array.section_starts = {3000};
  const auto rms = [&](const std::string& name, Eigen::Index from, Eigen::Index count) {
    auto bound = test::make(name, array);
    bound->learn(y, x);
    bound->finish_learning();
    return std::sqrt((test::run(*bound, y).x - x).middleCols(from, count).squaredNorm() / static_cast<double>(count));
  };
  CHECK(rms("sectioned-least-squares", 0, 3000) == Approx(1 / std::sqrt(1.5)).epsilon(0.03));
  // Weights that sum to one may lean on a channel that is dead at zero, the mean of the input: variance 2 * 25 / 27.
  CHECK(rms("sectioned-least-squares", 3000, 3000) == Approx(std::sqrt(50.0 / 27)).epsilon(0.03));
  CHECK(rms("optimal-weights", 0, 6000) > rms("sectioned-least-squares", 0, 6000));
  CHECK(rms("best-sensor", 0, 6000) == Approx(2).epsilon(0.03));
}

namespace {

/// Weights of five channels, the last ones made of the first three by `copy`.
Eigen::VectorXd learnt_weights(Eigen::Index rows, const std::function<void(Eigen::VectorXd&)>& copy,
                               libchar::Findings& warnings, const std::string& name = "optimal-weights",
                               double level = 0) {
  test::Gaussian gauss(21);
  Array array = test::array(5);
  array.reference_throughout = true;
  array.learning_samples = rows;
  auto fusion = test::make(name, array);
  Eigen::MatrixXd y(5, 1000), x(1, 1000);
  for (Eigen::Index from = 0; from < rows; from += y.cols()) {
    for (Eigen::Index k = 0; k < y.cols(); ++k) {
      x(0, k) = level + 3 * std::sin(0.01 * static_cast<double>(from + k));
      Eigen::VectorXd channels = Eigen::VectorXd::Zero(5);
      for (Eigen::Index i = 0; i < 3; ++i) channels[i] = x(0, k) + 0.2 * (1.0 + static_cast<double>(i)) * gauss();
      copy(channels);
      y.col(k) = channels;
    }
    fusion->learn(y, x);
  }
  fusion->finish_learning();
  fusion->remarks(warnings);
  return *fusion->weights();
}

}  // namespace

TEST_CASE("least squares: one channel twice is one channel, however long the record") {
  // By 1/v: 36, 9 and 4 of 49; each copy has half of its original's.
  const Eigen::VectorXd expected = (Eigen::VectorXd(5) << 18, 4.5, 4, 18, 4.5).finished() / 49;
  for (const Eigen::Index rows : {2000, 20000, 200000})
    for (const bool as_float : {false, true}) {
      INFO(rows << (as_float ? " as float" : ""));
      libchar::Findings warnings;
      const Eigen::VectorXd w = learnt_weights(
          rows,
          [&](Eigen::VectorXd& y) {
            for (const Eigen::Index i : {0, 1})
              y[3 + i] = as_float ? static_cast<double>(static_cast<float>(y[i])) : y[i];
          },
          warnings);
      CHECK((w - expected).cwiseAbs().maxCoeff() < 3 / std::sqrt(static_cast<double>(rows)));
      REQUIRE(warnings.find("duplicate_channels") != nullptr);
      CHECK(warnings.find("duplicate_channels")->count == 2);
      CHECK(warnings.find("duplicate_channels")->where.rows[1] == "channel 5 of channel 2");
    }
}

TEST_CASE("least squares: channels made of others get the shortest weights") {
  for (const Eigen::Index rows : {2000, 200000}) {
    INFO(rows);
    libchar::Findings warnings;
    const Eigen::VectorXd w = learnt_weights(
        rows,
        [](Eigen::VectorXd& y) {
          y[3] = 0.5 * (y[0] + y[1]);
          y[4] = 0.5 * (y[1] + y[2]);
        },
        warnings);
    CHECK(w.cwiseAbs().maxCoeff() < 1.5);
    // What counts is what they come to.
    const Eigen::Vector3d total(w[0] + w[3] / 2, w[1] + (w[3] + w[4]) / 2, w[2] + w[4] / 2);
    CHECK((total - Eigen::Vector3d(36, 9, 4) / 49).cwiseAbs().maxCoeff() < 3 / std::sqrt(static_cast<double>(rows)));
    REQUIRE(warnings.find("dependent_channels") != nullptr);
    CHECK(warnings.find("dependent_channels")->count == 2);
  }
}

TEST_CASE("least squares: good channels far from zero are no copies") {
  libchar::Findings warnings;
  test::Gaussian gauss(5);
  const Eigen::VectorXd w = learnt_weights(
      2000,
      [&](Eigen::VectorXd& y) {
        for (const Eigen::Index i : {3, 4}) y[i] = y[0] + 0.02 * gauss();
      },
      warnings, "optimal-weights", 1e8);
  CHECK(warnings.find("duplicate_channels") == nullptr);
  CHECK(w.sum() == Approx(1).margin(1e-12));
}

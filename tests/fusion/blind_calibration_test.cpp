// Blind calibration: known answers for both gauges, the published recursion, and what taking off the noise is worth.

#include "libchar/fusion/algorithms/blind_calibration.hpp"

#include <catch2/catch.hpp>

#include "tests/fusion/vectors.hpp"
#include "tests/support/noise.hpp"

using namespace libchar::fusion;

TEST_CASE("blind calibration on the Gram matrix: two gauges") {
  const test::Vectors inputs("fusion_inputs.csv");
  const Eigen::MatrixXd u = inputs.block("u", 5);
  struct Case {
    std::string name;
    double gauge, absolute, relative, offset_absolute, offset_relative;
  };
  for (const Case& c : {Case{"reference sensor 1", 1, 1.44e-15, 1.55e-15, 1.21e-16, 4.08e-15},
                        Case{"mean of inverse gains = 1", 0, 6.66e-16, 5.97e-16, 6.16e-17, 9.01e-15}}) {
    INFO(c.name);
    const auto answer = test::answers()["blind_batch"][c.name];
    BlindCalibration blind(test::array(5),
                           test::settings("blind-calibration", {{"gauge", c.gauge}, {"noise_removal", 0}}));
    for (Eigen::Index k = 0; k < u.cols(); ++k) blind.step(Sample(u.col(k).data(), 5));
    blind.solve();
    CHECK(test::worst(blind.inverse_gain(), test::vector(answer["inverse_gain"]), c.absolute, c.relative) <= 1);
    CHECK(test::worst(blind.offset(), test::vector(answer["beta"]), c.offset_absolute, c.offset_relative) <= 1);
  }
}

TEST_CASE("blind-calibration-published: 50-digit vectors") {
  const test::Vectors inputs("fusion_inputs.csv"), expected("blind_thesis_ref1.csv");
  BlindCalibrationPublished blind(test::array(5), test::settings("blind-calibration-published", {}));
  const Eigen::MatrixXd u = inputs.block("u", 5), gain = expected.block("invgain", 5), beta = expected.block("beta", 5);
  double worst_gain = 0, worst_x = 0, worst_offset = 0;
  for (Eigen::Index k = 0; k < u.cols(); ++k) {
    const Estimate estimate = blind.step(Sample(u.col(k).data(), 5));
    worst_gain = std::max(worst_gain, test::worst(blind.inverse_gain(), gain.col(k), 5.86e-14, 5.85e-14));
    worst_offset = std::max(worst_offset, test::worst(blind.offset(), beta.col(k), 1e-15, 1e-14));
    worst_x = std::max(worst_x, test::worst(Eigen::MatrixXd(estimate.x),
                                            Eigen::MatrixXd::Constant(1, 1, expected["xhat"][k]), 1.14e-13, 1.94e-12));
  }
  CHECK(worst_gain <= 1);
  CHECK(worst_offset <= 1);
  CHECK(worst_x <= 1);
}

TEST_CASE("blind calibration: taking off the noise removes the bias of the gains") {
  const Eigen::VectorXd gain = (Eigen::VectorXd(5) << 1.005, 1.01, .96, .93, .9).finished();
  const Eigen::VectorXd variance = 623 * (Eigen::VectorXd(5) << 5e-3, 1e-3, 5e-4, 1e-4, 5e-5).finished();
  test::Gaussian gauss(4);
  Eigen::MatrixXd u(5, 100000);
  for (Eigen::Index k = 0; k < u.cols(); ++k) {
    const double x = std::sqrt(5.78) * gauss();
    for (Eigen::Index i = 0; i < 5; ++i)
      u(i, k) = gain[i] * x + 0.1 * static_cast<double>(i) + std::sqrt(variance[i]) * gauss();
  }
  const auto error = [&](bool levels, double removal) {
    Array array = test::array(5);
    if (levels) array.noise_levels = variance;
    BlindCalibration blind(array, test::settings("blind-calibration", {{"gauge", 5}, {"noise_removal", removal}}));
    for (Eigen::Index k = 0; k < u.cols(); ++k) blind.step(Sample(u.col(k).data(), 5));
    blind.solve();
    const Eigen::VectorXd estimated = blind.inverse_gain().cwiseInverse() * gain[4];
    return (estimated - gain).cwiseAbs().sum();
  };
  CHECK(error(false, 0) > 0.3);  // without noise compensation: 0.677 with another gauge
  CHECK(error(false, 1) < 0.03);
  CHECK(error(true, 1) < 0.03);
}

TEST_CASE("blind calibration: of two channels of unknown noise no noise is taken off") {
  // One factor and two noises cannot be told from three moments. On the Gram matrix, with the first
  // gain one, the other inverse gain is the regression of the first channel on the second.
  test::Gaussian gauss(8);
  Eigen::MatrixXd y(2, 1000);
  for (Eigen::Index k = 0; k < y.cols(); ++k) {
    const double x = gauss();
    y(0, k) = x + 0.2 * gauss();
    y(1, k) = 0.5 * x + 0.3 * gauss();
  }
  BlindCalibration blind(test::array(2), test::settings("blind-calibration", {{"gauge", 1}}));
  for (Eigen::Index k = 0; k < y.cols(); ++k) blind.step(Sample(y.col(k).data(), 2));
  blind.solve();
  const Eigen::MatrixXd off = y.colwise() - y.rowwise().mean();
  CHECK(blind.inverse_gain()[0] == Approx(1).epsilon(1e-12));
  CHECK(blind.inverse_gain()[1] == Approx(off.row(0).dot(off.row(1)) / off.row(1).squaredNorm()).epsilon(1e-9));
}

TEST_CASE("blind calibration: an offset of the input moves the estimate by itself") {
  // Four barometers: gains within a percent, the input 1013 with a swing of 3.
  test::Gaussian gauss(6);
  const Eigen::Vector4d gain(1.02, 0.99, 0.97, 1.01);
  Eigen::MatrixXd y(4, 4000);
  Eigen::RowVectorXd x(4000);
  for (Eigen::Index k = 0; k < y.cols(); ++k) {
    x[k] = 3 * std::sin(0.01 * static_cast<double>(k));
    for (Eigen::Index i = 0; i < 4; ++i) y(i, k) = gain[i] * x[k] + 0.05 * gauss();
  }
  for (const char* name : {"blind-calibration", "blind-gls"}) {
    INFO(name);
    const test::Values gauge{{"gauge", 0}};
    const Eigen::MatrixXd low = test::run(*test::make(name, test::array(4), gauge), y).x;
    const Eigen::MatrixXd high = test::run(*test::make(name, test::array(4), gauge), y.array() + 1013).x.array() - 1013;
    CHECK((low - high).cwiseAbs().maxCoeff() < 1e-9);
    // No worse than the plain mean, to which the gains are a correction.
    const double mean = (y.colwise().mean() - x).norm(), ours = (high - x).norm();
    CHECK(ours < 1.1 * mean);
  }
}

TEST_CASE("blind calibration: two channels cannot tell noise from gain unless its levels are known") {
  for (const bool known : {false, true}) {
    Array array = test::array(2);
    if (known) array.noise_levels = Eigen::Vector2d(0.04, 0.01);
    test::Gaussian gauss(8);
    Eigen::MatrixXd y(2, 20000);
    for (Eigen::Index k = 0; k < y.cols(); ++k) {
      const double x = gauss();
      y.col(k) << x + 0.2 * gauss(), 0.8 * x + 0.1 * gauss();
    }
    auto blind = test::make("blind-calibration", array, {{"gauge", 1}});
    CHECK(test::run(*blind, y).x.allFinite());
    libchar::Findings warnings;
    blind->remarks(warnings);
    CHECK(warnings.find("not_calibrated") == nullptr);
    CHECK((warnings.find("noise_bias") != nullptr) == !known);
  }
}

// Tilt filters against fixtures/known/fusion/tilt.csv, and what must hold for any tilt.

#include <Eigen/Core>
#include <catch2/catch.hpp>
#include <numbers>

#include "libchar/core/error.hpp"
#include "libchar/fusion/algorithms/tilt_complementary.hpp"
#include "libchar/fusion/algorithms/tilt_kalman.hpp"
#include "tests/fusion/vectors.hpp"
#include "tests/support/noise.hpp"

using namespace libchar::fusion;

namespace {

constexpr double kPi = std::numbers::pi;

Array tilt_array(double rate_hz = 100) {
  Array made = test::array(3);
  made.rate_hz = rate_hz;
  made.tilt = TiltChannels{};
  return made;
}

Eigen::MatrixXd samples_of(const test::Vectors& file) {
  return file.values.middleCols(file.column("gyro"), 3).transpose();
}

/// A slow turn through +-pi several times, with noise and a gyroscope bias; row 3 is the true angle.
Eigen::MatrixXd turning(Eigen::Index instants, double noise = 0.05, double bias = 0.02) {
  test::Gaussian gauss(3);
  Eigen::MatrixXd y(4, instants);
  for (Eigen::Index k = 0; k < instants; ++k) {
    const double angle = 0.5 * 0.01 * static_cast<double>(k + 1);
    y(0, k) = 0.5 + bias + 0.01 * gauss();
    y(1, k) = 9.81 * (std::sin(angle) + noise * gauss());
    y(2, k) = 9.81 * (std::cos(angle) + noise * gauss());
    y(3, k) = wrapped(angle);
  }
  return y;
}

}  // namespace

TEST_CASE("tilt: 50-digit vectors") {
  const test::Vectors file("tilt.csv");
  const auto answer = test::answers()["tilt"];
  const Array array = tilt_array(1 / answer["dt"].get<double>());
  const Eigen::MatrixXd y = samples_of(file);
  const auto run = [&](const char* name, const test::Values& values = {}) {
    return test::run(*test::make(name, array, values), y);
  };
  CHECK(test::worst(run("tilt-accelerometer").x, file["acc_angle_atan2"].transpose(), 4.5e-16) <= 1);
  // The sum of many rates: rounding grows with the number of instants.
  CHECK(test::worst(run("tilt-gyroscope", {{"start_at_zero", 1}}).x, file["gyro_integral"].transpose(), 2e-15) <= 1);
  CHECK(test::worst(run("tilt-complementary", {{"lambda", answer["lam"]}, {"start_at_zero", 1}}).x,
                    file["theta_cf"].transpose(), 8.88e-16) <= 1);
  const test::Run kalman = run("tilt-kalman", {{"angle_noise", answer["Qtheta"]},
                                               {"bias_noise", answer["Qbias"]},
                                               {"gravity_variance", answer["R"]},
                                               {"start_at_zero", 1}});
  CHECK(test::worst(kalman.x, file["theta_kf"].transpose(), 1.78e-15) <= 1);
  CHECK(test::worst(kalman.variance, file["P00"].transpose(), 0, 1e-14) <= 1);
}

TEST_CASE("tilt-kalman: bias and covariance of the 50-digit vectors") {
  const test::Vectors file("tilt.csv");
  const auto answer = test::answers()["tilt"];
  const Eigen::MatrixXd y = samples_of(file);
  TiltKalmanFilter filter({answer["Qtheta"], answer["Qbias"], answer["R"]}, answer["dt"], 0, true);
  Eigen::MatrixXd got(4, y.cols());
  for (Eigen::Index k = 0; k < y.cols(); ++k) {
    filter.step(tilt_sample({}, Sample(y.col(k).data(), 3)));
    got.col(k) << filter.bias(), filter.p00(), filter.p01(), filter.p11();
  }
  CHECK(test::worst(got.row(0), file["bias_kf"].transpose(), 3.59e-15) <= 1);
  CHECK(test::worst(got.row(1), file["P00"].transpose(), 0, 1e-14) <= 1);
  CHECK(test::worst(got.row(2), file["P01"].transpose(), 1e-22, 1e-14) <= 1);
  CHECK(test::worst(got.row(3), file["P11"].transpose(), 0, 1e-14) <= 1);
}

TEST_CASE("tilt: gain one and gain zero are the single sensors, bit for bit") {
  const Eigen::MatrixXd y = turning(3000).topRows(3);
  const Array array = tilt_array();
  const auto run = [&](const char* name, const test::Values& values = {}) {
    return test::run(*test::make(name, array, values), y).x;
  };
  CHECK(run("tilt-complementary", {{"lambda", 1}}) == run("tilt-gyroscope"));
  CHECK((run("tilt-complementary", {{"lambda", 0}}) - run("tilt-accelerometer"))
            .unaryExpr([](double off) { return wrapped(off); })
            .cwiseAbs()
            .maxCoeff() < 1e-15);
  const Eigen::MatrixXd deaf = run(
      "tilt-kalman", {{"gravity_variance", 1e200}, {"start_bias_variance", 0}, {"angle_noise", 0}, {"bias_noise", 0}});
  // It starts with the variance of gravity, so its second sample still counts half.
  const Eigen::MatrixXd trusting = run("tilt-kalman", {{"gravity_variance", 1e-200}, {"angle_noise", 1}});
  CHECK(
      (trusting - run("tilt-accelerometer")).unaryExpr([](double off) { return wrapped(off); }).cwiseAbs().maxCoeff() <
      1e-15);
  CHECK(deaf.allFinite());
  const Eigen::MatrixXd from_zero = run("tilt-kalman", {{"gravity_variance", 1e200}, {"start_at_zero", 1}});
  CHECK((from_zero - run("tilt-gyroscope", {{"start_at_zero", 1}})).cwiseAbs().maxCoeff() < 1e-13);
}

TEST_CASE("tilt: filters follow a turn through +-pi and learn the bias") {
  const Eigen::MatrixXd y = turning(20000);
  for (const char* name : {"tilt-complementary", "tilt-kalman"}) {
    INFO(name);
    const Eigen::MatrixXd x = test::run(*test::make(name, tilt_array()), y.topRows(3)).x;
    CHECK(x.cwiseAbs().maxCoeff() <= kPi);
    const Eigen::ArrayXd off = (x.row(0) - y.row(3)).array().unaryExpr([](double a) { return wrapped(a); });
    CHECK(std::sqrt(off.tail(15000).square().mean()) < 0.03);
  }
  TiltKalmanFilter filter({}, 0.01, 1e-4, false);
  for (Eigen::Index k = 0; k < y.cols(); ++k) filter.step(tilt_sample({}, Sample(y.col(k).data(), 3)));
  CHECK(filter.bias() == Approx(0.02).margin(5 * std::sqrt(filter.p11())));
  CHECK(std::sqrt(filter.p11()) < 0.005);
}

TEST_CASE("tilt: a missing angle is prediction only, a missing rate holds the last one") {
  const double gap = std::nan("");
  TiltKalmanFilter filter({}, 0.01, 1e-4, false), other = filter;
  ComplementaryFilter blend(0.9, 0.01, false);
  for (const TiltSample s : {TiltSample{1, 0.1}, TiltSample{1, 0.11}}) {
    filter.step(s);
    other.step(s);
    blend.step(s);
  }
  const double before = filter.step({1, 0.12}), bias = filter.bias(), p11 = filter.p11();
  CHECK(filter.step({2, gap}) == before + (2 - bias) * 0.01);
  CHECK(filter.bias() == bias);
  CHECK(filter.p11() == p11 + TiltNoise{}.bias * 0.01);
  CHECK(filter.step({gap, gap}) == before + (2 - bias) * 0.01 + (2 - bias) * 0.01);
  const double blended = blend.step({1, gap});
  CHECK(blend.step({3, gap}) == blended + 3 * 0.01);

  // No angle of gravity: from a missing axis, or from two zeros.
  auto accelerometer = test::make("tilt-accelerometer", tilt_array());
  Eigen::MatrixXd y(3, 4);
  y << 0, 0, gap, 0,  //
      gap, 0, 1, 1,   //
      1, 0, 1, std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd x = test::run(*accelerometer, y).x;
  CHECK(std::isnan(x(0, 0)));
  CHECK(std::isnan(x(0, 1)));
  CHECK(x(0, 2) == Approx(kPi / 4));
  CHECK(std::isnan(x(0, 3)));
  // Nothing is known before the first angle of gravity.
  for (const char* name : {"tilt-complementary", "tilt-kalman", "tilt-gyroscope"}) {
    const Eigen::MatrixXd started = test::run(*test::make(name, tilt_array()), y).x;
    CHECK(std::isnan(started(0, 1)));
    CHECK(started(0, 2) == Approx(kPi / 4));
    CHECK(started(0, 3) == Approx(kPi / 4));
  }
}

TEST_CASE("tilt-kalman: the covariance stays positive, and settles at the Riccati solution") {
  struct Case {
    TiltNoise noise;
    double start;
  };
  for (const Case& c : {Case{{1e-5, 1e-3, 1e-2}, 1e-4}, Case{{0, 0, 1e-12}, 1e12}, Case{{1e12, 0, 1e-12}, 1e12},
                        Case{{1e-12, 1e-12, 1e12}, 0}}) {
    TiltKalmanFilter filter(c.noise, 0.002, c.start, false);
    for (int k = 0; k < 1000000; ++k) filter.step({0.1, 0.3});
    Eigen::Matrix2d p;
    p << filter.p00(), filter.p01(), filter.p01(), filter.p11();
    CHECK(filter.p00() > 0);
    CHECK(filter.p11() >= 0);
    CHECK(p(0, 0) * p(1, 1) - p(0, 1) * p(1, 0) >= -1e-15 * p(0, 0) * p(1, 1));
    if (!(c.noise.bias > 0) || c.noise.gravity > 1) continue;
    // P = (F P F' + Q)(I - K H) leaves P where it is.
    Eigen::Matrix2d f;
    f << 1, -0.002, 0, 1;
    Eigen::Matrix2d predicted = f * p * f.transpose();
    predicted(0, 0) += c.noise.angle * 0.002;
    predicted(1, 1) += c.noise.bias * 0.002;
    const Eigen::Vector2d gain = predicted.col(0) / (predicted(0, 0) + c.noise.gravity);
    const Eigen::Matrix2d after = predicted - gain * predicted.row(0);
    CHECK((after - p).cwiseAbs().maxCoeff() <= 1e-10 * p.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("tilt: blocks of any size give the same bits") {
  Eigen::MatrixXd y = turning(500).topRows(3);
  y.block(1, 100, 1, 30).setConstant(std::nan(""));
  for (const char* name : {"tilt-gyroscope", "tilt-accelerometer", "tilt-complementary", "tilt-kalman"}) {
    INFO(name);
    const Eigen::MatrixXd whole = test::run(*test::make(name, tilt_array()), y).x;
    for (const Eigen::Index block : {1, 7, 64}) {
      const Eigen::MatrixXd parts = test::run(*test::make(name, tilt_array()), y, 1, block).x;
      CHECK(((parts.array() == whole.array()) || (parts.array().isNaN() && whole.array().isNaN())).all());
    }
  }
}

TEST_CASE("tilt tuned: near the best constants there are, unlike noise, unlike constants") {
  const Eigen::MatrixXd y = turning(20000);
  Array array = tilt_array();
  array.learning_samples = 10000;
  const auto rms = [&](const std::string& name, const test::Values& values = {}) {
    auto runner = test::make(name, array, values);
    runner->learn(y.topLeftCorner(3, 10000), y.block(3, 0, 1, 10000));
    runner->finish_learning();
    const Eigen::MatrixXd x = test::run(*runner, y.topRightCorner(3, 10000)).x;
    const Eigen::ArrayXd off =
        (x.row(0) - y.block(3, 10000, 1, 10000)).array().unaryExpr([](double a) { return wrapped(a); });
    return std::sqrt(off.tail(9000).square().mean());
  };
  double best_blend = 1, best_kalman = 1;
  for (double decades = -2; decades <= 2; decades += 0.25)
    best_blend = std::min(best_blend, rms("tilt-complementary", {{"time_constant", std::pow(10, decades)}}));
  for (double angle = -9; angle <= -3; angle += 1)
    for (double bias = -12; bias <= -4; bias += 1)
      best_kalman = std::min(best_kalman, rms("tilt-kalman", {{"angle_noise", std::pow(10, angle)},
                                                              {"bias_noise", std::pow(10, bias)},
                                                              {"gravity_variance", 0.0025}}));
  const double blend = rms("tilt-complementary-tuned"), kalman = rms("tilt-kalman-tuned");
  CHECK(blend < 1.1 * best_blend);
  CHECK(kalman < 1.25 * best_kalman);
  CHECK(kalman < blend);

  auto deaf = test::make("tilt-kalman-tuned", array);
  Eigen::MatrixXd silent = y.topLeftCorner(3, 1000);
  silent.row(1).setConstant(std::nan(""));
  deaf->learn(silent, y.block(3, 0, 1, 1000));
  CHECK_THROWS_AS(deaf->finish_learning(), libchar::Error);
}

TEST_CASE("tilt: the start is the mean over start_s, and what comes after it is the filter") {
  // A tenth of a second at 100 Hz: ten angles of gravity.
  const auto angle_after = [](Eigen::Index at) {
    Eigen::MatrixXd y = Eigen::MatrixXd::Zero(3, at + 1);
    y.row(2).setConstant(9.81);
    y(1, at) = 9.81 * std::sin(0.1);
    y(2, at) = 9.81 * std::cos(0.1);
    return test::run(*test::make("tilt-complementary", tilt_array(), {{"lambda", 0.99}, {"start_s", 0.1}}), y).x(0, at);
  };
  CHECK(angle_after(1) == Approx(0.1 / 2).epsilon(1e-12));
  CHECK(angle_after(9) == Approx(0.1 / 10).epsilon(1e-12));
  CHECK(angle_after(10) == Approx(0.1 * 0.01).epsilon(1e-9));
}

TEST_CASE("tilt tuned: what has learnt nothing says nothing of it") {
  for (const char* name : {"tilt-complementary-tuned", "tilt-kalman-tuned"}) {
    Array array = tilt_array();
    array.learning_samples = 1000;
    auto runner = test::make(name, array);
    libchar::Findings warnings;
    runner->remarks(warnings);
    CHECK(warnings.empty());
  }
}

TEST_CASE("tilt: a wild first sample of the accelerometer is not carried on") {
  Eigen::MatrixXd y = turning(20000, 0.02, 0).topRows(3);
  const Eigen::MatrixXd truth = turning(20000, 0.02, 0).row(3);
  y(1, 0) += 9;  // a knock: tens of degrees
  const auto error = [&](const char* name, const test::Values& values) {
    const Eigen::MatrixXd x = test::run(*test::make(name, tilt_array(), values), y).x;
    return std::sqrt((x - truth).unaryExpr([](double a) { return wrapped(a); }).rightCols(19500).squaredNorm() / 19500);
  };
  CHECK(error("tilt-gyroscope", {{"start_s", 0}}) > 0.5);
  CHECK(error("tilt-gyroscope", {}) < 0.05);
  CHECK(error("tilt-complementary", {{"time_constant", 100}}) < 0.05);
}

TEST_CASE("tilt: the start is the mean over start_s, not an instant more") {
  // Three instants of 1/4 s make a mean; then the gyroscope, which stands still.
  ComplementaryFilter filter(1, 0.25, false, 0.75);
  CHECK(filter.step({0, 0.1}) == 0.1);
  CHECK(filter.step({0, 0.2}) == Approx(0.15).epsilon(1e-14));
  CHECK(filter.step({0, 0.6}) == Approx(0.3).epsilon(1e-14));
  CHECK(filter.step({0, -0.5}) == Approx(0.3).epsilon(1e-14));
}

TEST_CASE("tilt tuned: constants are said once they are learnt") {
  const Eigen::MatrixXd y = turning(300);
  for (const char* name : {"tilt-complementary-tuned", "tilt-kalman-tuned"}) {
    INFO(name);
    Array array = tilt_array();
    array.learning_samples = 300;
    auto runner = test::make(name, array);
    libchar::Findings before, after;
    runner->remarks(before);
    CHECK(before.empty());
    runner->learn(y.topRows(3), y.bottomRows(1));
    runner->finish_learning();
    runner->remarks(after);
    CHECK(after.find("tilt_tuned") != nullptr);
  }
}

// Tilt filters on recordings with missing and unevenly spaced samples, against the sampled truth.

#include <catch2/catch.hpp>

#include "libchar/fusion/algorithms/tilt_kalman.hpp"
#include "tests/fusion/scenes.hpp"
#include "tests/fusion/vectors.hpp"

using namespace libchar::fusion;

namespace {

constexpr Eigen::Index kGapInstants = 4000;

struct Swing {
  Eigen::MatrixXd y, truth;
  Array array;
};

/// A tilt of 0.7 sin 2t, sampled at 100 Hz; instants off by `jitter` of an interval.
Swing swing(double jitter = 0, double gyroscope_noise = 0.01, double gravity_noise = 0.02) {
  Swing made;
  made.array = test::tilt_scene().array;
  made.y.resize(3, kGapInstants);
  made.truth.resize(1, kGapInstants);
  test::Gaussian gauss(8);
  for (Eigen::Index k = 0; k < kGapInstants; ++k) {
    const double off = jitter * std::clamp(gauss(), -3.0, 3.0);
    const double t = (static_cast<double>(k + 1) + off) / 100, angle = 0.7 * std::sin(2 * t);
    made.truth(0, k) = angle;
    made.y(0, k) = 1.4 * std::cos(2 * t) + gyroscope_noise * gauss();
    made.y(1, k) = 9.81 * (std::sin(angle) + gravity_noise * gauss());
    made.y(2, k) = 9.81 * (std::cos(angle) + gravity_noise * gauss());
  }
  return made;
}

const test::Values kTuned{{"angle_noise", 1e-6}, {"bias_noise", 1e-9}, {"gravity_variance", 4e-4}};

test::Run kalman(const Swing& swing) { return test::run(*test::make("tilt-kalman", swing.array, kTuned), swing.y); }

double rms(const Eigen::MatrixXd& x, const Swing& swing) {
  return std::sqrt((x - swing.truth).rightCols(kGapInstants - 500).squaredNorm() / (kGapInstants - 500));
}

}  // namespace

TEST_CASE("tilt: an instant without samples takes its time") {
  // A steady turn and a perfect gyroscope: nothing is lost by a gap of one second.
  Eigen::MatrixXd y(3, 400);
  for (Eigen::Index k = 0; k < 400; ++k) {
    const double angle = 0.3 * static_cast<double>(k + 1) / 100;
    y.col(k) << 0.3, std::sin(angle), std::cos(angle);
  }
  y.middleCols(150, 100).setConstant(test::kNaN);
  Array array = test::tilt_scene().array;
  for (const char* name : {"tilt-gyroscope", "tilt-complementary", "tilt-kalman"}) {
    INFO(name);
    const Eigen::MatrixXd x = test::run(*test::make(name, array), y).x;
    for (Eigen::Index k = 0; k < 400; ++k)
      REQUIRE(x(0, k) == Approx(0.3 * static_cast<double>(k + 1) / 100).margin(1e-12));
  }
}

TEST_CASE("tilt-kalman: a silent gyroscope costs accuracy, and the variance says so") {
  const Swing whole = swing();
  Swing silent = whole;
  for (Eigen::Index k = 600; k + 50 < kGapInstants; k += 400) silent.y.row(0).segment(k, 50).setConstant(test::kNaN);
  const test::Run good = kalman(whole), held = kalman(silent);
  CHECK(rms(good.x, whole) < 0.006);
  // Holding the last rate for half a second alone would be off by up to 0.35 rad.
  CHECK(rms(held.x, silent) < 0.012);
  CHECK((held.x - silent.truth).rightCols(kGapInstants - 500).cwiseAbs().maxCoeff() < 0.1);
  // In the gaps the errors stay within what the filter claims: mean square over claimed variance.
  double squares = 0, count = 0;
  for (Eigen::Index k = 600; k + 50 < kGapInstants; k += 400)
    for (Eigen::Index j = k; j < k + 50; ++j) {
      squares += std::pow(held.x(0, j) - silent.truth(0, j), 2) / held.variance(0, j);
      count += 1;
    }
  CHECK(squares / count < 2);
  CHECK(held.variance(0, 640) > 10 * good.variance(0, 640));
  CHECK((held.variance.array() > 0).all());
}

TEST_CASE("tilt-kalman: everything missing is prediction, with a variance that covers it") {
  const Swing whole = swing();
  Swing gap = whole;
  gap.y.middleCols(1000, 30).setConstant(test::kNaN);
  const test::Run out = kalman(gap);
  for (Eigen::Index k = 1000; k < 1030; ++k) {
    REQUIRE(out.variance(0, k) > out.variance(0, k - 1));
    REQUIRE(std::abs(out.x(0, k) - gap.truth(0, k)) < 3 * std::sqrt(out.variance(0, k)));
  }
  // A few seconds of samples later it is as good as before.
  CHECK(std::abs(out.x(0, 1100) - gap.truth(0, 1100)) < 0.02);
  CHECK(out.variance(0, 1500) < 1.1 * out.variance(0, 990));
}

TEST_CASE("tilt: silent accelerometers are no update") {
  const Swing whole = swing();
  Swing deaf = whole;
  deaf.y.block(1, 2000, 2, 100).setConstant(test::kNaN);
  const Eigen::MatrixXd x = kalman(deaf).x;
  // One second on the gyroscope alone: its noise and what is left of the bias.
  CHECK((x - deaf.truth).middleCols(2000, 100).cwiseAbs().maxCoeff() < 0.03);
  // Either axis alone points nowhere: the same as none.
  Swing half = whole;
  half.y.block(1, 2000, 1, 100).setConstant(test::kNaN);
  CHECK(kalman(half).x == x);
}

TEST_CASE("tilt: jitter of a tenth of an interval is lost in the noise") {
  const Swing even = swing(), uneven = swing(0.1);
  for (const char* name : {"tilt-complementary", "tilt-kalman"}) {
    INFO(name);
    const auto error = [&](const Swing& swing) {
      return rms(test::run(*test::make(name, swing.array), swing.y).x, swing);
    };
    CHECK(error(uneven) < 1.2 * error(even));
  }
}

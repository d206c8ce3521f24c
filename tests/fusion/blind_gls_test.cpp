// Blind gains with variances: what is found, what it is worth, and what missing samples cost.

#include "libchar/fusion/algorithms/blind_gls.hpp"

#include <catch2/catch.hpp>

#include "tests/fusion/vectors.hpp"
#include "tests/support/noise.hpp"

using namespace libchar::fusion;

namespace {

struct Uncalibrated {
  Eigen::MatrixXd y;
  Eigen::VectorXd x, gain, variance;
};

/// Five sensors of [RV 3.3]: gains and noise of its table, no offsets.
Uncalibrated uncalibrated(Eigen::Index instants, std::uint64_t seed) {
  Uncalibrated made;
  made.gain = (Eigen::VectorXd(5) << 1.005, 1.01, .96, .93, .9).finished();
  made.variance = 623 * (Eigen::VectorXd(5) << 5e-3, 1e-3, 5e-4, 1e-4, 5e-5).finished();
  made.y.resize(5, instants);
  made.x.resize(instants);
  test::Gaussian gauss(seed);
  for (Eigen::Index k = 0; k < instants; ++k) {
    made.x[k] = std::sqrt(5.78) * gauss();
    for (Eigen::Index i = 0; i < 5; ++i)
      made.y(i, k) = made.gain[i] * made.x[k] + std::sqrt(made.variance[i]) * gauss();
  }
  return made;
}

/// Standard deviation of x - a estimate - b, the best line.
double after_gain_and_offset(const Eigen::VectorXd& estimate, const Eigen::VectorXd& x) {
  const Eigen::VectorXd e = estimate.array() - estimate.mean(), t = x.array() - x.mean();
  const double slope = e.dot(t) / e.squaredNorm();
  return std::sqrt((t - slope * e).squaredNorm() / static_cast<double>(x.size()));
}

}  // namespace

TEST_CASE("blind-gls: gains and variances, to a gauge, and the optimum of weights") {
  for (const std::uint64_t seed : {4, 5, 6}) {
    const Uncalibrated s = uncalibrated(100000, seed);
    BlindGls blind(test::array(5), test::settings("blind-gls", {{"gauge", 5}}));
    Eigen::VectorXd x(s.x.size());
    for (Eigen::Index k = 0; k < s.y.cols(); ++k) x[k] = blind.step(Sample(s.y.col(k).data(), 5)).x[0];
    CHECK((blind.gain() * s.gain[4] - s.gain).cwiseAbs().sum() < 0.05);
    CHECK((blind.variances().cwiseQuotient(s.variance).array() - 1).abs().maxCoeff() < 0.15);
    // Gauss-Markov with everything known: 1 / sum g^2 / v.
    const double best = 1 / std::sqrt(s.gain.cwiseAbs2().cwiseQuotient(s.variance).sum());
    CHECK(after_gain_and_offset(x.tail(90000), s.x.tail(90000)) < 1.01 * best);
  }
}

TEST_CASE("blind-gls: a sensor at a tenth of the rate takes nothing from the others") {
  const Uncalibrated s = uncalibrated(60000, 7);
  Eigen::MatrixXd holes = s.y;
  for (Eigen::Index k = 0; k < holes.cols(); ++k)
    if (k % 10 != 3) holes(4, k) = std::nan("");
  const test::Values gauge{{"gauge", 1}};
  auto whole = test::make("blind-gls", test::array(5), gauge), slow = test::make("blind-gls", test::array(5), gauge);
  const Eigen::MatrixXd a = test::run(*whole, s.y).x, b = test::run(*slow, holes).x;
  CHECK(b.allFinite());
  const Eigen::VectorXd g = *whole->weights(), h = *slow->weights();
  CHECK((g - h).cwiseAbs().maxCoeff() < 0.1);
  // Without the best one, the optimum of the other four; with it, that of all.
  const auto optimum = [&](Eigen::Index n) {
    return 1 / std::sqrt(s.gain.head(n).cwiseAbs2().cwiseQuotient(s.variance.head(n)).sum());
  };
  double with = 0, without = 0;
  const double slope = s.gain[0];
  for (Eigen::Index k = 30000; k < b.cols(); ++k)
    (std::isnan(holes(4, k)) ? without : with) += std::pow(b(0, k) - slope * s.x[k], 2);
  CHECK(std::sqrt(without / 27000) < 1.05 * optimum(4));
  CHECK(std::sqrt(with / 3000) < 1.1 * optimum(5));
}

TEST_CASE("blind-gls: a scene that stands still is the plain mean, and that is said") {
  test::Gaussian gauss(2);
  Eigen::MatrixXd y(4, 3000);
  for (double& v : y.reshaped()) v = 7 + gauss();
  auto blind = test::make("blind-gls", test::array(4));
  const Eigen::MatrixXd x = test::run(*blind, y).x;
  libchar::Findings warnings;
  blind->remarks(warnings);
  CHECK(warnings.find("not_calibrated") != nullptr);
  CHECK((x - y.colwise().mean()).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("blind-gls: no channel is taken to be more than a hundred times better than all others") {
  // One channel is the input itself: its variance runs to zero in half of the records.
  double largest = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    test::Gaussian gauss(seed);
    Eigen::MatrixXd y(4, 2000);
    for (Eigen::Index k = 0; k < y.cols(); ++k) {
      y(0, k) = gauss();
      for (Eigen::Index i = 1; i < 4; ++i) y(i, k) = y(0, k) + 0.5 * gauss();
    }
    BlindGls blind(test::array(4), test::settings("blind-gls", {{"gauge", 1}}));
    for (Eigen::Index k = 0; k < y.cols(); ++k) blind.step(Sample(y.col(k).data(), 4));
    // w g is the information of each channel.
    const Eigen::VectorXd share = blind.weights().col(0).cwiseProduct(blind.gain());
    CHECK(share.sum() == Approx(1).epsilon(1e-12));
    CHECK(share[0] <= 100.0 / 101 + 1e-9);
    largest = std::max(largest, share[0]);
  }
  CHECK(largest == Approx(100.0 / 101).epsilon(1e-9));
}

TEST_CASE("blind-gls: the first gains come after three instants for each channel, 20 at least") {
  for (const auto& [channels, first] : {std::pair{4, 20}, std::pair{8, 24}, std::pair{12, 36}}) {
    test::Gaussian gauss(9);
    Eigen::MatrixXd y(channels, 60);
    for (Eigen::Index k = 0; k < y.cols(); ++k) {
      const double x = 5 * gauss();
      for (Eigen::Index i = 0; i < channels; ++i) y(i, k) = x + 0.1 * gauss();
    }
    const Eigen::MatrixXd variance = test::run(*test::make("blind-gls", test::array(channels)), y).variance;
    CAPTURE(channels);
    CHECK(variance.array().isNaN().count() == first - 1);
    CHECK(std::isnan(variance(0, first - 2)));
  }
}

TEST_CASE("blind-gls: the middle gain is one by default, also beside a turned sign") {
  test::Gaussian gauss(12);
  const double gain[] = {-1.0, 0.95, 1.0, 1.0, 1.1};
  BlindGls blind(test::array(5), test::settings("blind-gls", {}));
  for (int k = 0; k < 4000; ++k) {
    const double x = 3 * gauss();
    double y[5];
    for (int i = 0; i < 5; ++i) y[i] = gain[i] * x + 0.1 * gauss();
    blind.step(Sample(y, 5));
  }
  for (int i = 0; i < 5; ++i) CHECK(blind.gain()[i] == Approx(gain[i]).margin(0.01));
}

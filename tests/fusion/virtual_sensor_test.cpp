// The virtual sensor against the Riccati equation in closed form and step by step, against a Kalman
// filter as a textbook has it, and on sensors whose white noise and drift say opposite things.

#include "libchar/fusion/algorithms/virtual_sensor.hpp"

#include <Eigen/Core>
#include <catch2/catch.hpp>

#include "libchar/core/error.hpp"
#include "tests/fusion/scenes.hpp"
#include "tests/fusion/vectors.hpp"
#include "tests/support/algebra.hpp"
#include "tests/support/noise.hpp"

using namespace libchar::fusion;

namespace {

Array drifting_array(const std::vector<NoiseModel>& models, double rate_hz) {
  Array array = test::array(static_cast<Eigen::Index>(models.size()));
  array.noise_models = models;
  array.rate_hz = rate_hz;
  array.noise_levels.resize(array.channels);
  for (Eigen::Index i = 0; i < array.channels; ++i) array.noise_levels[i] = models[static_cast<std::size_t>(i)].white;
  return array;
}

/// A filter of the biases with the whole equation at every instant, the input of huge variance left
/// out by projection: no doubling, no schedule.
struct Textbook {
  Eigen::MatrixXd h, c, p;
  Eigen::VectorXd white, b;
  BiasStates states;

  Textbook(const Array& array, const BiasStates& of)
      : h(array.h()),
        c(Eigen::MatrixXd::Zero(array.channels, of.size())),
        p(of.start.asDiagonal()),
        white(array.noise_levels),
        b(Eigen::VectorXd::Zero(of.size())),
        states(of) {
    for (Eigen::Index s = 0; s < of.size(); ++s) c(of.channel[static_cast<std::size_t>(s)], s) = 1;
  }
  Eigen::VectorXd step(const Eigen::VectorXd& y, const std::vector<Eigen::Index>& present) {
    const Eigen::MatrixXd hp = h(present, Eigen::indexing::all), cp = c(present, Eigen::indexing::all);
    Eigen::MatrixXd s = cp * p * cp.transpose();
    s.diagonal() += white(present);
    const Eigen::MatrixXd inverse = test::inverse(s);
    const Eigen::MatrixXd w = test::inverse(hp.transpose() * inverse * hp) * hp.transpose() * inverse;
    const Eigen::VectorXd e = y(present) - cp * b;
    const Eigen::VectorXd x = w * e;
    const Eigen::MatrixXd gain =
        p * cp.transpose() * inverse * (Eigen::MatrixXd::Identity(s.rows(), s.rows()) - hp * w);
    b += gain * e;
    p -= gain * cp * p;
    p = 0.5 * (p + p.transpose()).eval();
    b = states.pole.asDiagonal() * b;
    p = states.pole.asDiagonal() * p * states.pole.asDiagonal();
    p.diagonal() += states.drive;
    return x;
  }
};

std::vector<Eigen::Index> all_of(Eigen::Index n) {
  std::vector<Eigen::Index> all;
  for (Eigen::Index i = 0; i < n; ++i) all.push_back(i);
  return all;
}

/// Four sensors, Q 1, 1, 4, 4 and K 8, 8, 1, 1: the white ones drift.
struct Opposite {
  Array array;
  Eigen::MatrixXd y;
  Eigen::VectorXd x;
};

Opposite opposite(Eigen::Index instants, std::uint64_t seed, double rate_hz = 20) {
  const Eigen::Array4d q(1e-3, 1e-3, 4e-3, 4e-3), k = Eigen::Array4d(8, 8, 1, 1) * 2.5e-5;
  std::vector<NoiseModel> models;
  for (Eigen::Index i = 0; i < 4; ++i) models.push_back({q[i] * q[i] * rate_hz, 0, k[i], {}});
  Opposite made{drifting_array(models, rate_hz), Eigen::MatrixXd(4, instants), {}};
  made.x.resize(instants);
  test::Gaussian gauss(seed);
  Eigen::Array4d walk = Eigen::Array4d::Zero();
  for (Eigen::Index t = 0; t < instants; ++t) {
    made.x[t] = std::sin(2 * 3.14159265358979 * 5 * static_cast<double>(t) / rate_hz);
    for (Eigen::Index i = 0; i < 4; ++i) {
      made.y(i, t) = made.x[t] + walk[i] + q[i] * std::sqrt(rate_hz) * gauss();
      walk[i] += k[i] / std::sqrt(rate_hz) * gauss();
    }
  }
  return made;
}

double mean_rms(const Eigen::VectorXd& error, Eigen::Index length) {
  double sum = 0;
  const Eigen::Index cells = error.size() / length;
  for (Eigen::Index k = 0; k < cells; ++k) sum += std::pow(error.segment(k * length, length).mean(), 2);
  return std::sqrt(sum / static_cast<double>(cells));
}

}  // namespace

TEST_CASE("virtual-sensor: two sensors, one of them drifting, in closed form") {
  const double sigma = 0.3, tau = 5, r1 = 0.04, r2 = 0.09, rate = 10;
  const BiasFilter filter(drifting_array({{r1, 0, 0, {{sigma, tau}}}, {r2, 0, 0, {}}}, rate), 1e4, 100);
  REQUIRE(filter.states().size() == 1);
  // P = phi^2 P R / (P + R) + q with R = r1 + r2: the difference is what is seen.
  const double phi = std::exp(-1 / (rate * tau)), q = sigma * sigma * (1 - phi * phi), r = r1 + r2;
  const double half = r * (1 - phi * phi) - q;
  const double p = 0.5 * (-half + std::sqrt(half * half + 4 * q * r));
  CHECK(filter.steady_covariance()(0, 0) == Approx(p).epsilon(1e-12));
  // Independent errors p + r1 and r2.
  CHECK(filter.steady_variance()[0] == Approx(1 / (1 / (p + r1) + 1 / r2)).epsilon(1e-12));
}

TEST_CASE("virtual-sensor: the steady state is that of the equation iterated, to 1e-9") {
  std::vector<NoiseModel> models{
      {0.04, 0.02, 0, {}}, {0.01, 0, 0, {{0.2, 3}}}, {0.09, 0, 0, {{0.05, 0.7}, {0.3, 20}}}, {0.02, 0.05, 0, {}}};
  const Array array = drifting_array(models, 10);
  const BiasFilter filter(array, 30, 100);
  Textbook textbook(array, filter.states());
  REQUIRE(filter.states().size() >= 5);
  const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(4);
  for (int k = 0; k < 30000; ++k) textbook.step(nothing, all_of(4));
  const Eigen::MatrixXd& ours = filter.steady_covariance();
  CHECK((ours - textbook.p).cwiseAbs().maxCoeff() < 1e-9 * ours.cwiseAbs().maxCoeff());
  CHECK(ours == ours.transpose());
}

TEST_CASE("virtual-sensor: flicker is a sum of processes, within a tenth of its density") {
  const double b = 0.1, rate = 100;
  const BiasStates states = bias_states({{1e-6, b, 0, {}}}, rate, 1e4);
  // Well between the slowest and the fastest.
  for (const double f : {1e-3, 3e-3, 1e-2, 0.05, 0.2, 1.0}) {
    double density = 0;
    for (Eigen::Index s = 0; s < states.size(); ++s) {
      const double tau = -1 / (rate * std::log(states.pole[s]));
      density += 2 * states.start[s] * tau / (1 + std::pow(2 * 3.14159265358979 * f * tau, 2));
    }
    CHECK(density == Approx(b * b / (2 * 3.14159265358979 * f)).epsilon(0.1));
  }
}

TEST_CASE("virtual-sensor: the gains that stand do as well as the whole equation at every instant") {
  const Opposite scene = opposite(20000, 3);
  auto ours = test::make("virtual-sensor", scene.array);
  const test::Run run = test::run(*ours, scene.y);
  const BiasFilter filter(scene.array, 1e4, 100);
  Textbook textbook(scene.array, filter.states());
  Eigen::VectorXd exact(scene.x.size());
  for (Eigen::Index k = 0; k < scene.x.size(); ++k) exact[k] = textbook.step(scene.y.col(k), all_of(4))[0];
  const Eigen::VectorXd error = run.x.row(0).transpose() - scene.x;
  CHECK((run.x.row(0).transpose() - exact).norm() < 0.05 * (exact - scene.x).norm());
  for (const Eigen::Index length : {1, 200, 800})
    CHECK(mean_rms(error, length) < 1.01 * mean_rms(exact - scene.x, length));
}

TEST_CASE("virtual-sensor: white noise and drift that say opposite things") {
  double fixed = 0, ours = 0, fixed_slow = 0, ours_slow = 0, stated = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Opposite scene = opposite(20000, seed);
    const test::Run run = test::run(*test::make("virtual-sensor", scene.array), scene.y);
    const Eigen::VectorXd weighted =
        test::run(*test::make("inverse-variance", scene.array), scene.y).x.row(0).transpose();
    const Eigen::VectorXd a = weighted - scene.x, b = run.x.row(0).transpose() - scene.x;
    fixed += a.squaredNorm();
    ours += b.squaredNorm();
    stated += run.variance.sum();
    fixed_slow += std::pow(mean_rms(a, 800), 2);
    ours_slow += std::pow(mean_rms(b, 800), 2);
  }
  CHECK(ours < 0.95 * fixed);
  CHECK(ours_slow < 0.15 * fixed_slow);
  CHECK(ours == Approx(stated).epsilon(0.15));  // it knows how good it is
}

TEST_CASE("virtual-sensor: gaps, a slow sensor, two inputs, against the textbook") {
  Opposite scene = opposite(4000, 5);
  test::Gaussian gauss(8);
  for (Eigen::Index k = 0; k < scene.y.cols(); ++k) {
    if (k % 10 != 0) scene.y(2, k) = std::nan("");
    if (gauss.uniform() < 0.05) scene.y(0, k) = std::nan("");
    if (k > 2000 && k < 2010) scene.y.col(k).setConstant(std::nan(""));
  }
  auto ours = test::make("virtual-sensor", scene.array);
  const Eigen::MatrixXd x = test::run(*ours, scene.y).x;
  const BiasFilter filter(scene.array, 1e4, 100);
  Textbook textbook(scene.array, filter.states());
  double square = 0, exact = 0;
  for (Eigen::Index k = 0; k < x.cols(); ++k) {
    std::vector<Eigen::Index> present;
    for (Eigen::Index i = 0; i < 4; ++i)
      if (!std::isnan(scene.y(i, k))) present.push_back(i);
    CHECK(std::isnan(x(0, k)) == present.empty());
    if (present.empty()) continue;
    exact += std::pow(textbook.step(scene.y.col(k), present)[0] - scene.x[k], 2);
    square += std::pow(x(0, k) - scene.x[k], 2);
  }
  CHECK(square < 1.02 * exact);
}

TEST_CASE("virtual-sensor: several inputs are those of generalized least squares without drift") {
  test::FusionScene scene = test::lever_scene();
  for (NoiseModel& model : scene.array.noise_models) model.flicker = model.walk = 0;
  auto ours = test::make("virtual-sensor", scene.array);
  auto fixed = test::make("inverse-variance", scene.array);
  const test::Run a = test::run(*ours, scene.y, 2), b = test::run(*fixed, scene.y, 2);
  CHECK((a.x - b.x).cwiseAbs().maxCoeff() < 1e-10);
  CHECK((a.variance - b.variance).cwiseAbs().maxCoeff() < 1e-12);
  libchar::Findings warnings;
  ours->remarks(warnings);
  CHECK(warnings.find("no_drift") != nullptr);
}

TEST_CASE("virtual-sensor: it says when it looks ahead, and when there is no drift") {
  const auto remarked = [](double smoothed, double flicker) {
    const Array array = drifting_array(std::vector<NoiseModel>(3, NoiseModel{0.01, flicker, 0, {}}), 100);
    libchar::Findings warnings;
    test::make("virtual-sensor", array, {{"smoothed", smoothed}})->remarks(warnings);
    return std::pair{warnings.find("looks_ahead") != nullptr, warnings.find("no_drift") != nullptr};
  };
  CHECK(remarked(0, 0.05) == std::pair{false, false});
  CHECK(remarked(1, 0.05) == std::pair{true, false});
  CHECK(remarked(0, 0) == std::pair{false, true});
}

TEST_CASE("virtual-sensor: more states than allowed are refused") {
  std::vector<NoiseModel> models(40, {1e-4, 0.1, 0.01, {{0.1, 3}, {0.1, 30}}});
  try {
    test::make("virtual-sensor", drifting_array(models, 100), {{"most_states", 50}});
    FAIL("made");
  } catch (const libchar::Error& error) {
    CHECK(error.problem().code == "E0865");
  }
}

TEST_CASE("virtual-sensor: a model of the input, its steady state by plain iteration") {
  const double sigma = 0.3, tau = 5, rate = 10, deviation = 2, corner = 0.4;
  const Array array = drifting_array({{0.04, 0, 0, {{sigma, tau}}}, {0.09, 0, 0, {}}}, rate);
  const BiasFilter filter(array, 1e4, 100, {deviation, corner});
  // b, x, x'/w; y1 = x + b, y2 = x.
  const double a = 2 * 3.14159265358979323846 * corner / rate, phi = std::exp(-1 / (rate * tau));
  Eigen::Matrix3d f = Eigen::Matrix3d::Zero(), q = f, p = f;
  f(0, 0) = phi;
  f.block<2, 2>(1, 1) << 1 + a, a, -a, 1 - a;
  f.block<2, 2>(1, 1) *= std::exp(-a);
  const Eigen::Matrix3d stationary =
      Eigen::Vector3d(sigma * sigma, deviation * deviation, deviation * deviation).asDiagonal();
  q = stationary - f * stationary * f.transpose();
  p = stationary;
  Eigen::Matrix<double, 2, 3> c;
  c << 1, 1, 0, 0, 1, 0;
  const Eigen::Matrix2d r = Eigen::Vector2d(0.04, 0.09).asDiagonal();
  Eigen::Matrix3d updated;
  for (int k = 0; k < 5000; ++k) {
    const Eigen::Matrix<double, 3, 2> gain = p * c.transpose() * test::inverse(c * p * c.transpose() + r);
    const Eigen::Matrix3d left = Eigen::Matrix3d::Identity() - gain * c;
    updated = left * p * left.transpose() + gain * r * gain.transpose();  // Joseph
    p = f * updated * f.transpose() + q;
  }
  CHECK((filter.steady_covariance() - p).cwiseAbs().maxCoeff() < 1e-9 * p.cwiseAbs().maxCoeff());
  CHECK(filter.steady_variance()[0] == Approx(updated(1, 1)).epsilon(1e-9));
}

TEST_CASE("virtual-sensor: an input model helps slow inputs, and one that says nothing changes nothing") {
  const double rate = 200;
  const Array array = drifting_array(std::vector<NoiseModel>(4, NoiseModel{0.01, 0.01, 0.001, {}}), rate);
  const auto errors = [&](double corner) {
    test::Gaussian gauss(12);
    const double a = 2 * 3.14159265358979 * corner / rate, keep = std::exp(-a);
    Eigen::MatrixXd y(4, 20000);
    Eigen::VectorXd truth(20000);
    double x = 0, u = 0;
    // Two equal poles, one after the other.
    for (Eigen::Index k = 0; k < y.cols(); ++k) {
      u = keep * u + gauss();
      x = keep * x + (1 - keep) * u;
      truth[k] = x;
      for (Eigen::Index i = 0; i < 4; ++i) y(i, k) = x + 0.1 * gauss();
    }
    const double size = std::sqrt(truth.squaredNorm() / 20000);
    const auto rms = [&](const test::Values& values) {
      auto fusion = test::make("virtual-sensor", array, values);
      return (test::run(*fusion, y).x.row(0).transpose() - truth).norm();
    };
    return rms({{"input_deviation", size}, {"input_corner_hz", corner}}) / rms({});
  };
  CHECK(errors(0.5) < 0.8);
  CHECK(errors(20) < 1.01);
  // White, of a hundred thousand times the noise: as good as no model.
  const Opposite scene = opposite(3000, 4);
  auto plain = test::make("virtual-sensor", scene.array);
  auto white = test::make("virtual-sensor", scene.array, {{"input_deviation", 1e3}, {"input_corner_hz", 1e5}});
  CHECK((test::run(*plain, scene.y).x - test::run(*white, scene.y).x).cwiseAbs().maxCoeff() < 1e-6);
}

TEST_CASE("virtual-sensor: who looks ahead says so, who does not does not") {
  for (const double smoothed : {0, 1}) {
    Array array = test::array(2);
    array.rate_hz = 10;
    array.noise_levels = Eigen::Vector2d(0.01, 0.04);
    array.noise_models = {{0.01, 0, 0.1, {}}, {0.04, 0, 0, {}}};
    libchar::Findings warnings;
    test::make("virtual-sensor", array, {{"smoothed", smoothed}})->remarks(warnings);
    CHECK((warnings.find("looks_ahead") != nullptr) == (smoothed == 1));
  }
}

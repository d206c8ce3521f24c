// The smoother of the virtual sensor against the whole problem solved at once: of all samples together
// with the covariance of all drifts at all instants, by least squares.

#include "libchar/fusion/detail/bias/bias_smoother.hpp"

#include <Eigen/Core>
#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/core/error.hpp"
#include "tests/fusion/scenes.hpp"
#include "tests/fusion/vectors.hpp"
#include "tests/support/algebra.hpp"
#include "tests/support/noise.hpp"

using namespace libchar::fusion;

namespace {

Array array_of(const std::vector<NoiseModel>& models, double rate_hz) {
  Array array = test::array(static_cast<Eigen::Index>(models.size()));
  array.noise_models = models;
  array.rate_hz = rate_hz;
  array.noise_levels.resize(array.channels);
  for (Eigen::Index i = 0; i < array.channels; ++i) array.noise_levels[i] = models[static_cast<std::size_t>(i)].white;
  return array;
}

/// Covariance of b_j and b_k of one state.
double drift_covariance(const BiasStates& states, Eigen::Index s, Eigen::Index j, Eigen::Index k) {
  double variance = states.start[s];
  for (Eigen::Index i = 0; i < std::min(j, k); ++i)
    variance = states.pole[s] * states.pole[s] * variance + states.drive[s];
  return variance * std::pow(states.pole[s], static_cast<double>(std::abs(j - k)));
}

/// All samples that are there, instant by instant: what they are of the inputs, and their covariance.
struct Whole {
  Eigen::MatrixXd h, covariance;
  Eigen::VectorXd y;
};

Whole whole(const Array& array, const BiasStates& states, const Eigen::MatrixXd& samples) {
  std::vector<std::pair<Eigen::Index, Eigen::Index>> there;  // instant, channel
  for (Eigen::Index k = 0; k < samples.cols(); ++k)
    for (Eigen::Index i = 0; i < samples.rows(); ++i)
      if (!std::isnan(samples(i, k))) there.emplace_back(k, i);
  const auto m = static_cast<Eigen::Index>(there.size());
  const Eigen::Index r = array.inputs();
  Whole out{Eigen::MatrixXd::Zero(m, r * samples.cols()), Eigen::MatrixXd::Zero(m, m), Eigen::VectorXd(m)};
  for (Eigen::Index a = 0; a < m; ++a) {
    const auto [k, i] = there[static_cast<std::size_t>(a)];
    out.y[a] = samples(i, k);
    out.h.block(a, r * k, 1, r) = array.h().row(i);
    for (Eigen::Index b = 0; b < m; ++b) {
      const auto [l, j] = there[static_cast<std::size_t>(b)];
      if (a == b) out.covariance(a, b) += array.noise_levels[i];
      for (Eigen::Index s = 0; i == j && s < states.size(); ++s)
        if (states.channel[static_cast<std::size_t>(s)] == i) out.covariance(a, b) += drift_covariance(states, s, k, l);
    }
  }
  return out;
}

/// Estimates (r x N) and their variances; `prior`: inverse covariance of all inputs, none: nothing is known.
test::Run solved(const Whole& all, Eigen::Index r, const Eigen::MatrixXd& prior = {}) {
  const Eigen::MatrixXd weight = test::inverse(all.covariance);
  Eigen::MatrixXd information = all.h.transpose() * weight * all.h;
  if (prior.size() > 0) information += prior;
  const Eigen::MatrixXd covariance = test::inverse(information);
  Eigen::MatrixXd x = covariance * all.h.transpose() * weight * all.y;
  Eigen::MatrixXd variance = covariance.diagonal();
  x.resize(r, x.size() / r);
  variance.resize(r, variance.size() / r);
  return {x, variance};
}

test::Run smoothed(const Array& array, const Eigen::MatrixXd& samples, test::Values values = {},
                   Eigen::Index block = 1 << 20) {
  values.emplace_back("smoothed", 1);
  auto runner = test::make("virtual-sensor", array, values);
  for (Eigen::Index k = 0; k < samples.cols(); k += block)
    runner->look(samples.middleCols(k, std::min(block, samples.cols() - k)));
  runner->finish_learning();
  return test::run(*runner, samples, array.inputs(), block);
}

std::vector<NoiseModel> unlike() {
  return {
      {0.04, 0.02, 0.01, {}}, {0.01, 0, 0.05, {{0.2, 3}}}, {0.09, 0, 0, {{0.05, 0.7}, {0.3, 20}}}, {0.02, 0.05, 0, {}}};
}

Eigen::MatrixXd random_samples(Eigen::Index n, Eigen::Index instants, std::uint64_t seed) {
  test::Gaussian gauss(seed);
  Eigen::MatrixXd y(n, instants);
  for (Eigen::Index k = 0; k < instants; ++k) {
    const double x = 3 * gauss();
    for (Eigen::Index i = 0; i < n; ++i) y(i, k) = x + 0.2 * gauss();
  }
  return y;
}

}  // namespace

TEST_CASE("virtual-sensor smoothed: the whole problem solved at once, to 1e-9") {
  // Up to where the filter computes its covariance at each instant.
  const Array array = array_of(unlike(), 10);
  const BiasStates states = bias_states(array.noise_models, array.rate_hz, 1e4);
  Eigen::MatrixXd y = random_samples(4, 16, 1);
  const auto check = [&] {
    const test::Run exact = solved(whole(array, states, y), 1), ours = smoothed(array, y);
    CHECK((ours.x - exact.x).cwiseAbs().maxCoeff() < 1e-9);
    CHECK((ours.variance - exact.variance).cwiseAbs().maxCoeff() < 1e-9);
  };
  check();
  auto filter = test::make("virtual-sensor", array);
  const test::Run before = test::run(*filter, y), after = smoothed(array, y);
  CHECK(after.x(0, 15) == before.x(0, 15));  // nothing follows it
  CHECK(after.variance(0, 15) == before.variance(0, 15));
  CHECK((after.variance.leftCols(15).array() < before.variance.leftCols(15).array()).all());
}

TEST_CASE("virtual-sensor smoothed: several inputs, and a model of the input") {
  Array array = array_of(unlike(), 10);
  array.observation_matrix.resize(4, 2);
  array.observation_matrix << 1, 0.3, 1, -0.4, 1, 1, 0.5, -1;
  const BiasStates states = bias_states(array.noise_models, array.rate_hz, 1e4);
  const Eigen::MatrixXd y = random_samples(4, 12, 2);
  const test::Run exact = solved(whole(array, states, y), 2), ours = smoothed(array, y);
  CHECK((ours.x - exact.x).cwiseAbs().maxCoeff() < 1e-9);
  CHECK((ours.variance - exact.variance).cwiseAbs().maxCoeff() < 1e-9);

  // x'' + 2 w x' + w^2 x = noise: covariance U^2 (1 + w t) e^-wt.
  const Array plain = array_of(unlike(), 10);
  const double deviation = 1.5, corner = 0.8;
  Eigen::MatrixXd prior(12, 12);
  for (Eigen::Index j = 0; j < 12; ++j)
    for (Eigen::Index k = 0; k < 12; ++k) {
      const double wt = 2 * 3.14159265358979323846 * corner / 10 * std::abs(static_cast<double>(j - k));
      prior(j, k) = deviation * deviation * (1 + wt) * std::exp(-wt);
    }
  const test::Run known = solved(whole(plain, states, y), 1, test::inverse(prior));
  const test::Run modelled = smoothed(plain, y, {{"input_deviation", deviation}, {"input_corner_hz", corner}});
  CHECK((modelled.x - known.x).cwiseAbs().maxCoeff() < 1e-8);
  CHECK((modelled.variance - known.variance).cwiseAbs().maxCoeff() < 1e-8);
}

TEST_CASE("virtual-sensor smoothed: gains that stand do as well as the whole problem, with gaps") {
  const Array array = array_of(unlike(), 10);
  const BiasStates states = bias_states(array.noise_models, array.rate_hz, 1e4);
  test::Gaussian gauss(4);
  const Eigen::Index instants = 250;
  Eigen::MatrixXd y(4, instants);
  Eigen::VectorXd drift(states.size()), truth(instants);
  for (Eigen::Index s = 0; s < states.size(); ++s) drift[s] = std::sqrt(states.start[s]) * gauss();
  for (Eigen::Index k = 0; k < instants; ++k) {
    truth[k] = 3 * gauss();
    for (Eigen::Index i = 0; i < 4; ++i) y(i, k) = truth[k] + std::sqrt(array.noise_levels[i]) * gauss();
    for (Eigen::Index s = 0; s < states.size(); ++s) {
      y(states.channel[static_cast<std::size_t>(s)], k) += drift[s];
      drift[s] = states.pole[s] * drift[s] + std::sqrt(states.drive[s]) * gauss();
    }
    if (k % 3 == 1) y(2, k) = test::kNaN;
    if (gauss.uniform() < 0.05) y(0, k) = test::kNaN;
  }
  const test::Run exact = solved(whole(array, states, y), 1), ours = smoothed(array, y);
  const double best = (exact.x.row(0).transpose() - truth).norm();
  CHECK((ours.x.row(0).transpose() - truth).norm() < 1.01 * best);
  CHECK((ours.x - exact.x).norm() < 0.05 * best);
  // Each set of channels has its variance; gaps do not enlarge that of the drifts.
  CHECK((ours.variance.array() / exact.variance.array()).maxCoeff() < 1.05);
  CHECK((ours.variance.array() / exact.variance.array()).minCoeff() > 0.9);
  y.col(100).setConstant(test::kNaN);
  const test::Run with_gap = smoothed(array, y);
  CHECK(std::isnan(with_gap.x(0, 100)));
  CHECK(std::isnan(with_gap.variance(0, 100)));
  CHECK(std::isfinite(with_gap.x(0, 99)));
}

TEST_CASE("virtual-sensor smoothed: the same bits in any blocks, in time turned round, once more") {
  const Array array = array_of(unlike(), 10);
  const Eigen::MatrixXd y = random_samples(4, 9000, 5);
  const test::Run one = smoothed(array, y), many = smoothed(array, y, {}, 7);
  CHECK(test::same_values(one.x, many.x));
  CHECK(test::same_values(one.variance, many.variance));
  // In the middle of a long run it does not matter which end came first (errors are about .1).
  const test::Run turned = smoothed(array, y.rowwise().reverse());
  CHECK((one.x.middleCols(3000, 3000) - turned.x.rowwise().reverse().middleCols(3000, 3000)).cwiseAbs().maxCoeff() <
        1e-2);
  auto runner = test::make("virtual-sensor", array, {{"smoothed", 1}});
  runner->look(y);
  runner->finish_learning();
  const test::Run first = test::run(*runner, y), second = test::run(*runner, y);
  CHECK(test::same_values(first.x, second.x));
}

TEST_CASE("virtual-sensor smoothed: a run longer than there is room for is refused") {
  const Array array = array_of(unlike(), 10);
  auto runner = test::make("virtual-sensor", array, {{"smoothed", 1}, {"most_mb", 1}});
  const Eigen::MatrixXd y = random_samples(4, 24576, 6);  // 40 bytes each, 4096 together
  runner->look(y);
  try {
    runner->look(y.leftCols(4096));
    FAIL("kept");
  } catch (const libchar::Error& error) {
    CHECK(error.problem().code == "E0868");
  }
}

TEST_CASE("virtual-sensor smoothed: better than the filter where sensors drift, and it knows how much") {
  const double rate = 20;
  const std::vector<NoiseModel> models{{2e-5, 0, 2e-4, {}}, {2e-5, 0, 2e-4, {}}, {3.2e-4, 0, 2.5e-5, {}}};
  const Array array = array_of(models, rate);
  double ours = 0, filtered = 0, stated = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    test::Gaussian gauss(seed);
    Eigen::MatrixXd y(3, 20000);
    Eigen::Array3d walk = Eigen::Array3d::Zero();
    for (Eigen::Index k = 0; k < y.cols(); ++k)
      for (Eigen::Index i = 0; i < 3; ++i) {
        const NoiseModel& model = models[static_cast<std::size_t>(i)];
        y(i, k) = walk[i] + std::sqrt(model.white) * gauss();
        walk[i] += model.walk / std::sqrt(rate) * gauss();
      }
    const test::Run run = smoothed(array, y);
    ours += run.x.squaredNorm();
    stated += run.variance.sum();
    filtered += test::run(*test::make("virtual-sensor", array), y).x.squaredNorm();
  }
  CHECK(ours < filtered);
  CHECK(ours == Approx(stated).epsilon(0.3));
}

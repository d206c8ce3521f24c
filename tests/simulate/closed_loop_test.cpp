// Simulate, fit, compare: the numbers of [RV tables 2.1 and 2.2], each fitted jointly, over 24
// seeds. ([RV] 2 reads single points off the curves, which finds 0.0040 +- 0.0028
// for K and 2.9 times too much for the random walk of the spectrum.)
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/coefficient.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "libchar/simulate/sensor_array.hpp"

using namespace libchar;

namespace {

struct Truth {
  double q, b, k, rate_hz;
  std::uint64_t samples;
};

std::vector<double> record(const Truth& truth, std::uint64_t seed) {
  ArraySimulation s;
  s.rate_hz = truth.rate_hz;
  s.samples = truth.samples;
  s.seed = seed;
  SensorModel m;
  m.rate_hz = truth.rate_hz;
  const double values[] = {truth.q, truth.b, truth.k};
  for (std::size_t t = 0; t < 3; ++t) {
    m.noise[t].status = Status::given;
    m.noise[t].value = values[t];
  }
  s.sensors = {{"g", m, {1}}};
  ArraySimulator simulator(s);
  const auto block = simulator.next(truth.samples);
  return {block[0].begin(), block[0].end()};
}

struct Coverage {
  int white = 0, flicker = 0, walk = 0, level = 0;
};

bool covers(const Coefficient& c, double truth) {
  if (c.value) return truth >= c.ci95.low && truth <= c.ci95.high;
  return c.upper95 && truth <= *c.upper95;
}

// ln S(1 Hz) with its standard deviation from the covariance of the fit's ln theta.
bool level_covers(const NoiseFit& fit, const Truth& truth) {
  const double dt = 1 / truth.rate_hz;
  const Mixture right = {truth.q * truth.q, truth.b * truth.b, truth.k * truth.k, 0, 0};
  const double expected = spectrum(right, 1, dt), found = spectrum(fit.theta, 1, dt);
  double variance = 0;
  const auto weight = [&](std::size_t t) { return fit.theta[t] * unit_spectrum(static_cast<Term>(t), 1, dt) / found; };
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) variance += weight(i) * weight(j) * fit.covariance[i][j];
  return std::abs(std::log(found / expected)) < 1.96 * std::sqrt(variance);
}

Coverage coverage_of(const Truth& truth) {
  Coverage count;
  FitOptions options;
  options.second_opinion = false;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const NoiseFit fit = fit_record(record(truth, seed), truth.rate_hz, nullptr, options);
    count.white += covers(fit[Term::white], truth.q);
    count.flicker += covers(fit[Term::flicker], truth.b);
    count.walk += covers(fit[Term::walk], truth.k);
    count.level += level_covers(fit, truth);
  }
  return count;
}

}  // namespace

// 24 records at 95 %: fewer than 20 happens once in 170 times.
TEST_CASE("closed loop: gyroscope of [RV table 2.1]") {
  const double floor = std::sqrt(2 * std::numbers::ln2 / std::numbers::pi);
  const Coverage count = coverage_of({0.016, 0.0017 / floor, 0.0040 / 60, 10, 300000});
  CHECK(count.white >= 20);
  CHECK(count.flicker >= 20);
  CHECK(count.walk >= 20);
  CHECK(count.level >= 20);
}

TEST_CASE("closed loop: accelerometer of [RV table 2.2], one-sided densities") {
  const double pi = std::numbers::pi;
  const Truth truth = {std::sqrt(3e-7 / 2), std::sqrt(pi * 1e-7), std::sqrt(2 * pi * pi * 5e-10), 100, 1000000};
  // The composite at 1 Hz, one-sided, is the sum of the table's three densities (but for sampling).
  const Mixture theta = {truth.q * truth.q, truth.b * truth.b, truth.k * truth.k, 0, 0};
  CHECK(2 * spectrum(theta, 1, 1e-2) == Approx(3e-7 + 1e-7 + 5e-10).epsilon(1e-3));
  const Coverage count = coverage_of(truth);
  CHECK(count.white >= 20);
  CHECK(count.flicker >= 20);
  CHECK(count.walk >= 20);
  CHECK(count.level >= 20);
}

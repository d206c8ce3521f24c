#include "libchar/simulate/detail/sensor_chain.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/core/numeric/moments.hpp"
#include "tests/support/shared.hpp"
#include "tests/support/table.hpp"

using namespace libchar;

namespace {

// fusion/kat.json, "sensor_model": the temperature given there is the distance from the reference.
SensorModel oracle_model() {
  SensorModel m;
  m.unit = "U";
  m.rate_hz = 1000;
  m.scale_factor = {1.02, 0, 1e-4, 2e-6};
  m.nonlinearity = {0.01, 0.003, -0.02, -0.001};
  m.bias = {0.05, 0, 1e-3, -2e-5};
  m.reference_temperature_degc = 0;
  m.bandwidth_hz = 100;
  m.saturation_low = -1;
  m.saturation_high = 1;
  m.sensitivity.gain = 0.8;
  m.resolution = 0.0625;
  return m;
}

std::vector<double> run(const SensorModel& m, std::vector<double> x, double temperature, bool from_zero = true) {
  SensorChain chain(m, {1000, 1, 0, from_zero});
  chain.run(x, std::vector<double>(x.size(), temperature));
  return x;
}

}  // namespace

TEST_CASE("sensor chain: every block against 50 digits") {
  const auto rows = test::table(test::known("fusion/sensor_model.csv"));
  std::vector<double> x;
  for (std::size_t i = 1; i < rows.size(); ++i) x.push_back(std::stod(rows[i][1]));
  REQUIRE(x.size() > 100);
  const SensorModel all = oracle_model();
  SensorModel sum = all;  // up to block 3
  sum.bandwidth_hz = std::nullopt;
  sum.saturation_low = sum.saturation_high = std::nullopt;
  sum.sensitivity.gain = 1;
  sum.resolution = std::nullopt;
  SensorModel filtered = sum;
  filtered.bandwidth_hz = 100;
  SensorModel saturated = filtered;
  saturated.saturation_low = -1;
  saturated.saturation_high = 1;
  SensorModel scaled = saturated;
  scaled.sensitivity.gain = 0.8;
  const struct {
    const SensorModel& model;
    std::size_t column;
  } steps[] = {{sum, 5}, {filtered, 6}, {saturated, 7}, {scaled, 8}, {all, 9}};
  for (const auto& step : steps) {
    const std::vector<double> y = run(step.model, x, 35);
    for (std::size_t i = 0; i < y.size(); ++i) {
      INFO("column " << step.column << " row " << i);
      CHECK(std::abs(y[i] - std::stod(rows[i + 1][step.column])) < 5e-15);
    }
  }
}

TEST_CASE("sensor chain: an identity model passes the input bit for bit") {
  const std::vector<double> x = {1.5, -0.0, 1e300, std::nan(""), 5e-324};
  SensorModel m;
  m.rate_hz = 10;
  std::vector<double> y = x;
  SensorChain(m, {10, 1, 0, false}).run(y, {});
  for (std::size_t i = 0; i < x.size(); ++i) CHECK(((std::isnan(x[i]) && std::isnan(y[i])) || x[i] == y[i]));
}

TEST_CASE("sensor chain: the draws of a device are its own and spread as told") {
  SensorModel m;
  m.rate_hz = 10;
  m.scale_factor = {2, 0.1, 0, 0};
  m.bias = {-1, 0.5, 0, 0};
  Moments scale, bias;
  for (std::uint64_t device = 0; device < 4000; ++device) {
    const DeviceDraw draw = SensorChain(m, {10, 7, device, false}).draw();
    scale.push({&draw.scale_factor, 1});
    bias.push({&draw.bias, 1});
  }
  CHECK(scale.mean() == Approx(2).margin(0.1 / std::sqrt(4000.0) * 4));
  CHECK(scale.standard_deviation() == Approx(0.1).epsilon(0.05));
  CHECK(bias.mean() == Approx(-1).margin(0.5 / std::sqrt(4000.0) * 4));
  CHECK(bias.standard_deviation() == Approx(0.5).epsilon(0.05));
  CHECK(SensorChain(m, {10, 7, 3, false}).draw().bias == SensorChain(m, {10, 7, 3, false}).draw().bias);
}

TEST_CASE("sensor chain: low-passed noise is stationary from the first sample") {
  SensorModel m;
  m.rate_hz = 100;
  m.bandwidth_hz = 1;
  m.noise[0] = {Status::given, 1.0, {}, 0, false, {}, 0, {}, {}, {}};
  const double a = std::exp(-2 * 3.14159265358979 * 0.01);
  for (const auto sampling : {NoiseSampling::per_sample, NoiseSampling::band_limited}) {
    m.noise_sampling = sampling;
    const double expected = sampling == NoiseSampling::per_sample ? 100 * (1 - a) / (1 + a) : 3.14159265358979;
    Moments first;
    for (std::uint64_t device = 0; device < 3000; ++device) {
      std::vector<double> y(1, 0.0);
      SensorChain(m, {100, 5, device, false}).run(y, {});
      first.push(y);
    }
    CHECK(first.variance() == Approx(expected).epsilon(0.1));
  }
}

TEST_CASE("sensor chain: a missing input does not stop the filter") {
  SensorModel m;
  m.rate_hz = 100;
  m.bandwidth_hz = 10;
  std::vector<double> y = {1, 1, std::nan(""), 1, 1};
  SensorChain(m, {100, 1, 0, false}).run(y, {});
  CHECK(std::isnan(y[2]));
  CHECK(y[4] == Approx(1));
}

TEST_CASE("sensor chain: the bias follows a lagging temperature, to the third order") {
  SensorModel m;
  m.rate_hz = 1000;
  m.reference_temperature_degc = 20;
  m.bias.tc1_per_k = 2;
  m.bias.tc3_per_k3 = 0.5;
  SensorChain instant(m, {1000, 1, 0});
  std::vector<double> y(2, 0.0);
  instant.run(y, std::vector<double>{20, 22});
  CHECK(y[0] == 0);
  CHECK(y[1] == Approx(2 * 2 + 0.5 * 8));
  m.bias.lag_s = 0.5;
  m.bias.tc3_per_k3 = 0;
  SensorChain lagging(m, {1000, 1, 0});
  std::vector<double> temperature(2001, 21.0), z(2001, 0.0);
  temperature[0] = 20;
  lagging.run(z, temperature);
  CHECK(z[0] == 0);
  CHECK(z[500] == Approx(2 * (1 - std::exp(-1.0))).epsilon(1e-9));
  CHECK(z[2000] == Approx(2 * (1 - std::exp(-4.0))).epsilon(1e-9));
}

TEST_CASE("sensor chain: steps, warm-ups and ramps only when asked, across blocks") {
  SensorModel m;
  m.rate_hz = 10;
  using Kind = DeterministicTerm::Kind;
  m.deterministic = {{Kind::step, 5, 2, 0, 0, 0}, {Kind::warm_up, 0, 1, 0, 3, 0}, {Kind::ramp, 0, 0, 0, 0, 0.1}};
  ChainOptions options{10, 1, 0};
  std::vector<double> none(100, 0.0), all(100, 0.0);
  SensorChain(m, options).run(none, {});
  CHECK(none == std::vector<double>(100, 0.0));
  options.deterministic = true;
  SensorChain chain(m, options);
  chain.run(std::span(all).first(37), {});
  chain.run(std::span(all).subspan(37), {});
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double t = static_cast<double>(i) / 10;
    CHECK(all[i] == Approx((t >= 5 ? 2 : 0) + std::exp(-t / 3) + 0.1 * t));
  }
}

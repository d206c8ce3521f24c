// Against the simulator: what it makes has the variance that is said.
#include "libchar/replay/detail/plan/noise_level.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "libchar/core/error.hpp"
#include "libchar/simulate/sensor_array.hpp"

using namespace libchar;

namespace {

void set(SensorModel& m, Term term, double value) {
  m.noise[static_cast<std::size_t>(term)].status = Status::given;
  m.noise[static_cast<std::size_t>(term)].value = value;
}

struct Measured {
  double variance = 0, half_square_difference = 0;
};

Measured simulated(const SensorModel& m, double rate_hz, std::uint64_t oversampling) {
  ArraySimulation s;
  s.rate_hz = rate_hz;
  s.samples = 1000000;
  s.oversampling = oversampling;
  s.seed = 7;
  s.sensors = {{"s", m, {1}}};
  ArraySimulator simulator(s);
  Measured result;
  double last = NAN, sum = 0, square = 0, difference = 0;
  while (true) {
    const auto block = simulator.next(8192);
    if (block.empty()) break;
    for (const double y : block[0]) {
      sum += y;
      square += y * y;
      if (!std::isnan(last)) difference += (y - last) * (y - last);
      last = y;
    }
  }
  const double n = 1e6;
  result.variance = square / n - sum * sum / n / n;
  result.half_square_difference = difference / (2 * (n - 1));
  return result;
}

}  // namespace

TEST_CASE("white noise: held, filtered, band-limited, as it is", "[noise_level]") {
  SensorModel m;
  set(m, Term::white, 0.02);
  SECTION("as it is") {
    CHECK(sample_noise_variance(m, 50) == Approx(4e-4 * 50).epsilon(1e-14));
    CHECK(simulated(m, 50, 1).variance == Approx(sample_noise_variance(m, 50)).epsilon(0.006));
  }
  SECTION("oversampled: one sample in four is kept") {
    CHECK(sample_noise_variance(m, 50, 4) == Approx(4e-4 * 200).epsilon(1e-14));
  }
  SECTION("low-pass") {
    m.bandwidth_hz = 8;
    CHECK(simulated(m, 50, 1).variance == Approx(sample_noise_variance(m, 50)).epsilon(0.01));
    CHECK(simulated(m, 50, 3).variance == Approx(sample_noise_variance(m, 50, 3)).epsilon(0.01));
  }
  SECTION("band-limited") {
    m.bandwidth_hz = 8;
    m.noise_sampling = NoiseSampling::band_limited;
    CHECK(sample_noise_variance(m, 50) == Approx(4e-4 * std::numbers::pi * 8).epsilon(1e-14));
    CHECK(simulated(m, 50, 1).variance == Approx(sample_noise_variance(m, 50)).epsilon(0.01));
  }
  SECTION("held, whole and broken numbers of steps, with and without a low-pass") {
    for (const double hold_s : {0.005, 0.010, 0.0123, 0.03, 0.07})
      for (const bool filtered : {false, true}) {
        INFO(hold_s << (filtered ? " filtered" : ""));
        m.white_hold_s = hold_s;
        m.bandwidth_hz = filtered ? std::optional(8.0) : std::nullopt;
        // Held longer than a sample there are fewer independent values.
        CHECK(simulated(m, 50, 4).variance == Approx(sample_noise_variance(m, 50, 4)).epsilon(0.02));
      }
  }
}

TEST_CASE("the scenes of the source", "[noise_level]") {
  SensorModel m;
  SECTION("3.3: 608.4 S of white noise") {
    set(m, Term::white, std::sqrt(5e-3));
    m.white_hold_s = 0.0005;
    m.bandwidth_hz = 200;
    CHECK(sample_noise_variance(m, 1000, 4) / 5e-3 == Approx(608.43).epsilon(2e-5));
    CHECK(simulated(m, 1000, 4).variance == Approx(sample_noise_variance(m, 1000, 4)).epsilon(0.005));
    const double white = sample_noise_variance(m, 1000, 4);
    set(m, Term::flicker, std::sqrt(2 * std::numbers::pi * 5e-3));
    m.flicker_hold_s = 1;
    // One sample in a thousand sees the level change, by 4/pi B^2 in the mean square.
    const double more = (sample_noise_variance(m, 1000, 4) - white) / 5e-3;
    CHECK(more > 0);
    CHECK(more < 2 * std::numbers::pi * 2 / std::numbers::pi / 1000);
  }
  SECTION("5.1: 304.2 Q^2") {
    set(m, Term::white, 3e-3);
    m.white_hold_s = 0.001;
    m.bandwidth_hz = 100;
    CHECK(sample_noise_variance(m, 200, 5) / 9e-6 == Approx(304.2).epsilon(1e-4));
    CHECK(simulated(m, 200, 5).variance == Approx(sample_noise_variance(m, 200, 5)).epsilon(0.005));
  }
}

TEST_CASE("flicker and random walk: Allan variance at one sample", "[noise_level]") {
  SensorModel m;
  SECTION("exact at one sample") {
    set(m, Term::flicker, 0.3);
    CHECK(sample_noise_variance(m, 100) == Approx(0.09 * 2 / std::numbers::pi).epsilon(1e-14));
    m = {};
    set(m, Term::walk, 0.3);
    CHECK(sample_noise_variance(m, 100) == Approx(0.09 / 100 / 2).epsilon(1e-14));
  }
  for (const Term term : {Term::flicker, Term::walk})
    for (const std::uint64_t oversampling : {1, 4})
      for (const double bandwidth : {0.0, 5.0, 30.0}) {
        m = {};
        set(m, term, 0.3);
        if (bandwidth > 0) m.bandwidth_hz = bandwidth;
        INFO(static_cast<int>(term) << " x" << oversampling << " " << bandwidth << " Hz");
        CHECK(simulated(m, 100, oversampling).half_square_difference ==
              Approx(sample_noise_variance(m, 100, oversampling)).epsilon(0.01));
      }
  SECTION("held flicker") {
    m = {};
    set(m, Term::flicker, 0.3);
    for (const double hold_s : {0.005, 0.03, 0.1})
      for (const bool filtered : {false, true}) {
        INFO(hold_s << (filtered ? " filtered" : ""));
        m.flicker_hold_s = hold_s;
        m.bandwidth_hz = filtered ? std::optional(8.0) : std::nullopt;
        CHECK(simulated(m, 100, 4).half_square_difference == Approx(sample_noise_variance(m, 100, 4)).epsilon(0.015));
      }
  }
}

TEST_CASE("quantization, rounding, output gain, bias and ramp are no noise", "[noise_level]") {
  SensorModel m;
  set(m, Term::quantization, 2e-4);
  CHECK(simulated(m, 100, 1).variance == Approx(sample_noise_variance(m, 100)).epsilon(0.01));
  m.bandwidth_hz = 20;
  CHECK(simulated(m, 100, 1).variance == Approx(sample_noise_variance(m, 100)).epsilon(0.01));
  m = {};
  set(m, Term::white, 0.02);
  set(m, Term::ramp, 5);
  m.bias.value = 9;
  m.sensitivity.gain = -3;
  m.resolution = 0.5;
  CHECK(sample_noise_variance(m, 100) == Approx(9 * 0.04 + 0.25 / 12).epsilon(1e-14));
  set(m, Term::ramp, 0);
  m.bias.value = 0;
  CHECK(simulated(m, 100, 1).variance == Approx(sample_noise_variance(m, 100)).epsilon(0.01));
  CHECK(sample_noise_variance({}, 100) == 0);
}

TEST_CASE("a rate or model that says nothing is refused", "[noise_level]") {
  SensorModel m;
  CHECK_THROWS_AS(sample_noise_variance(m, 0), Error);
  CHECK_THROWS_AS(sample_noise_variance(m, NAN), Error);
  CHECK_THROWS_AS(sample_noise_variance(m, 100, 0), Error);
  m.noise_sampling = NoiseSampling::band_limited;
  CHECK_THROWS_AS(sample_noise_variance(m, 100), Error);
}

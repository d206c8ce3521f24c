// Known delays, whole and fractional; missing samples; nothing to find; the robot's 0.10 s.
#include "libchar/replay/detail/align/lag.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "libchar/log/read.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// A sum of sines up to 0.3 of the rate, without a common period: defined at any time.
double motion(double t) {
  double x = 0;
  for (int i = 1; i <= 12; ++i) x += std::sin(0.157 * std::pow(i, 0.97) * t + 1.7 * i * i) / std::sqrt(i);
  return x;
}

struct Two {
  std::vector<double> sensor, reference;
};

Two delayed(double lag_samples, std::size_t count, double noise = 0, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Two two;
  for (std::size_t k = 0; k < count; ++k) {
    const auto t = static_cast<double>(k);
    two.reference.push_back(motion(t));
    two.sensor.push_back(3 + 2 * motion(t - lag_samples) + noise * normal(random));
  }
  return two;
}

}  // namespace

TEST_CASE("a known delay is found to a thousandth of a sample, whole or not", "[lag]") {
  for (const double lag : {0.0, 1.0, -7.0, 0.5, 12.25, -3.4, 40.1}) {
    const Two two = delayed(lag, 5000);
    const LagEstimate found = estimate_lag(two.sensor, two.reference, 100, 0.5);
    INFO(lag);
    CHECK(found.lag_s * 100 == Approx(lag).margin(2e-3));
    CHECK(found.correlation > 0.999);
    const LagEstimate other = estimate_lag(two.reference, two.sensor, 100, 0.5);
    CHECK(other.lag_s * 100 == Approx(-lag).margin(2e-3));
  }
}

TEST_CASE("a delay in noise, in a large offset, with missing samples", "[lag]") {
  Two two = delayed(5.3, 20000, 1.5);
  for (double& v : two.sensor) v += 1e7;
  for (std::size_t k = 0; k < two.sensor.size(); k += 7) two.sensor[k] = kNaN;
  for (std::size_t k = 3000; k < 6000; ++k) two.reference[k] = kNaN;
  const LagEstimate found = estimate_lag(two.sensor, two.reference, 100, 0.2);
  CHECK(found.lag_s * 100 == Approx(5.3).margin(0.05));
  CHECK(found.correlation > 0.7);
}

TEST_CASE("white noise delayed by whole samples", "[lag]") {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> x(4000), y(4000);
  for (double& v : x) v = normal(random);
  for (std::size_t k = 0; k < y.size(); ++k) y[k] = k >= 9 ? x[k - 9] : 0;
  const LagEstimate found = estimate_lag(y, x, 1000, 0.05);
  CHECK(found.lag_s * 1000 == Approx(9).margin(0.02));
  CHECK(found.correlation > 0.99);
}

TEST_CASE("of a periodic signal the smallest lag", "[lag]") {
  std::vector<double> x(2000), y(2000);
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double t = static_cast<double>(k) * 2 * std::numbers::pi / 50;
    x[k] = std::sin(t);
    y[k] = std::sin(t - 0.3);
  }
  const LagEstimate found = estimate_lag(y, x, 1, 400);
  CHECK(found.lag_s == Approx(0.3 * 50 / (2 * std::numbers::pi)).margin(0.01));
}

TEST_CASE("a long record is searched on blocks first", "[lag]") {
  const Two two = delayed(2034.6, 60000, 0.5);
  const LagEstimate found = estimate_lag(two.sensor, two.reference, 1, 10000);
  CHECK(found.lag_s == Approx(2034.6).margin(0.02));
}

TEST_CASE("nothing to find is said", "[lag]") {
  const Two two = delayed(0, 2000);
  const std::vector<double> constant(2000, 0.1), missing(2000, kNaN), few = {1, 2, 3};
  for (const auto& sensor : {constant, missing}) {
    const LagEstimate none = estimate_lag(sensor, two.reference, 100, 0.3);
    CHECK(std::isnan(none.lag_s));
    CHECK(std::isnan(none.correlation));
    CHECK(std::isnan(estimate_lag(two.reference, sensor, 100, 0.3).lag_s));
  }
  CHECK(std::isnan(estimate_lag(few, few, 100, 0.3).lag_s));
  CHECK(std::isnan(estimate_lag({}, {}, 100, 0.3).lag_s));
  CHECK(std::isnan(estimate_lag(two.sensor, two.reference, 0, 0.3).lag_s));

  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::vector<double> a(2000), b(2000);
  for (double& v : a) v = normal(random);
  for (double& v : b) v = normal(random);
  CHECK_FALSE(estimate_lag(a, b, 100, 0.3).correlation >= 0.2);  // NaN or low
}

TEST_CASE("a delay outside the range is no lag", "[lag]") {
  std::vector<double> slow_x, slow_y;  // one bump: correlation grows towards the edge
  for (int k = 0; k < 3000; ++k) {
    slow_x.push_back(std::exp(-std::pow((k - 1000) / 200.0, 2)));
    slow_y.push_back(std::exp(-std::pow((k - 1200) / 200.0, 2)));
  }
  const LagEstimate none = estimate_lag(slow_y, slow_x, 1, 100);
  CHECK(std::isnan(none.lag_s));
  CHECK(std::isnan(none.correlation));
  CHECK(estimate_lag(slow_y, slow_x, 1, 300).lag_s == Approx(200).margin(0.01));
}

// The gyroscope lags the robot's encoders by 0.10 s (sanity figures of the recording).
TEST_CASE("the robot's lag is found", "[lag]") {
  const char* file = "data/tilt_robot_mpu9150_path1_150mms.csv";
  NEEDS_SHARED(file);
  ReadOptions options;
  options.channels = {"gyro_x", "ref_roll_about_x"};
  options.from_s = 16.513;
  options.to_s = 29.769;
  const Recording log = read_recording(test::shared(file).string(), options);
  const double rate = log.info.time.rate_hz;
  const auto gyroscope = log.channel(0), roll = log.channel(1);
  std::vector<double> roll_rate(roll.size(), kNaN);
  for (std::size_t k = 1; k < roll.size(); ++k) roll_rate[k] = (roll[k] - roll[k - 1]) * rate;
  const LagEstimate found = estimate_lag(gyroscope, roll_rate, rate, 1);
  CHECK(found.lag_s == Approx(0.10).margin(0.02));
  CHECK(found.correlation > 0.9);
}

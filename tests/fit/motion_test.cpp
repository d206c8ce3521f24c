#include "libchar/fit/signs/motion.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "libchar/fit/record/noise_powers.hpp"
#include "libchar/fit/signs/events.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/npy.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

constexpr double kMotionRate = 100;
constexpr std::size_t kMotionSamples = 100'000;
constexpr double kMotionQ = 5e-3, kMotionB = 5e-3, kMotionK = 1.5e-3, kMotionSigma = 0.05;

Motion motion_of(const std::vector<double>& y) { return find_motion(event_series(y, kMotionRate)); }

/// Student's t with five degrees of freedom, unit variance.
double student(test::Gaussian& gauss) {
  double chi2 = 0;
  for (int i = 0; i < 5; ++i) {
    const double g = gauss();
    chi2 += g * g;
  }
  return gauss() / std::sqrt(chi2 / 5) * std::sqrt(0.6);
}

}  // namespace

TEST_CASE("motion: records of noise have none, and none of their strength changes") {
  const std::array<std::array<double, 3>, 4> scenes = {
      {{kMotionQ, 0, 0}, {kMotionQ, kMotionB, kMotionK}, {kMotionQ, 0, 20 * kMotionK}, {0, 0, kMotionK}}};
  int alarms = 0;
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    test::NoiseSource source(kMotionSamples, kMotionRate, 200 + s);
    for (int r = 0; r < 30; ++r) {
      const Motion motion = motion_of(source.record(scenes[s][0], scenes[s][1], scenes[s][2]));
      REQUIRE(motion.tested);
      CHECK_FALSE(motion.whole);
      CHECK(motion.moving_s.empty());
      alarms += motion.changes.empty() ? 0 : 1;
    }
  }
  CHECK(alarms <= 3);
}

TEST_CASE("motion: heavy tails, steps and spikes are neither motion nor a change") {
  test::NoiseSource source(kMotionSamples, kMotionRate, 31);
  int changes = 0;
  for (int r = 0; r < 20; ++r) {
    std::vector<double> y = source.record(0, kMotionB, kMotionK);
    for (std::size_t t = 0; t < y.size(); ++t) {
      y[t] += kMotionSigma * student(source.gauss()) + (t > 61'803 ? 10 * kMotionSigma : 0);
      if (source.gauss().uniform() < 1e-3) y[t] += 15 * kMotionSigma;
    }
    const Motion motion = motion_of(y);
    CHECK_FALSE(motion.whole);
    CHECK(motion.moving_s.empty());
    changes += motion.changes.empty() ? 0 : 1;
  }
  CHECK(changes <= 1);
}

TEST_CASE("motion: a change of strength has its instant and its factor") {
  test::NoiseSource source(kMotionSamples, kMotionRate, 32);
  for (const double factor : {1.4, 2.0, 0.5}) {
    std::vector<double> y = source.record(0, kMotionB, kMotionK);
    for (std::size_t t = 0; t < y.size(); ++t) y[t] += kMotionSigma * source.gauss()() * (t >= 60'000 ? factor : 1);
    const Motion motion = motion_of(y);
    INFO("factor " << factor);
    REQUIRE(motion.changes.size() == 1);
    const StrengthChange& change = motion.changes[0];
    CHECK(change.kind == EventKind::step);
    CHECK(change.at_ci95.low < 600);
    CHECK(change.at_ci95.high > 600);
    CHECK(change.factor == Approx(factor).epsilon(0.08));
    CHECK(motion.moving_s.empty());
    CHECK(motion.findings.size() == 1);
  }
}

TEST_CASE("motion: the longest still stretch does not lie inside a louder one") {
  test::NoiseSource source(kMotionSamples, kMotionRate, 38);
  std::vector<double> y = source.record(0, 0, 0);
  for (std::size_t t = 0; t < y.size(); ++t)
    y[t] += kMotionSigma * source.gauss()() * (t >= 30'000 && t < 90'000 ? 1.6 : 1);
  const Motion motion = motion_of(y);
  REQUIRE(motion.louder_s.size() == 1);
  CHECK(motion.louder_s[0].low == Approx(300).margin(8));
  CHECK(motion.louder_s[0].high == Approx(900).margin(8));
  REQUIRE(motion.still_s.has_value());
  CHECK(motion.still_s->low == 0);
  CHECK(motion.still_s->high == Approx(300).margin(8));
}

TEST_CASE("motion: slow handling over a tenth of the record is motion, and no change of strength") {
  test::NoiseSource source(kMotionSamples, kMotionRate, 39);
  for (const double amplitude : {1.0, 4.0, 16.0}) {
    INFO("amplitude " << amplitude);
    std::vector<double> y = source.record(0, 0, 0);
    double slow = 0, hand = 0;
    for (std::size_t t = 0; t < y.size(); ++t) {
      y[t] += kMotionSigma * source.gauss()();
      slow += 0.1 * (source.gauss()() - slow);
      hand += 0.1 * (slow - hand);
      if (t >= 60'000 && t < 72'000) y[t] += 6.3 * amplitude * kMotionSigma * hand;
    }
    const Motion motion = motion_of(y);
    REQUIRE(motion.moving_s.size() == 1);
    CHECK(motion.moving_s[0].low == Approx(600).margin(14));
    CHECK(motion.moving_s[0].high == Approx(720).margin(14));
    CHECK(motion.changes.empty());
  }
}

TEST_CASE("motion: a handled stretch is found, and the longest still one") {
  test::NoiseSource source(kMotionSamples, kMotionRate, 33);
  std::vector<double> y = source.record(kMotionQ, kMotionB, kMotionK);
  for (std::size_t t = 30'000; t < 34'000; ++t)
    y[t] += 20 * kMotionSigma * std::sin(2 * std::numbers::pi * 1.3 * static_cast<double>(t) / kMotionRate);
  const Motion motion = motion_of(y);
  REQUIRE(motion.moving_s.size() == 1);
  CHECK(motion.moving_s[0].low <= 300);
  CHECK(motion.moving_s[0].high >= 340);
  CHECK(motion.moving_s[0].high - motion.moving_s[0].low < 70);
  REQUIRE(motion.still_s.has_value());
  CHECK(motion.still_s->low == Approx(motion.moving_s[0].high));
  CHECK(motion.still_s->high > 990);
}

TEST_CASE("motion: picked up early and put down late, steadily moved between") {
  test::NoiseSource source(kMotionSamples, kMotionRate, 36);
  std::vector<double> y = source.record(kMotionQ, kMotionB, kMotionK);
  for (std::size_t t = 8'000; t < 92'000; ++t) y[t] += 20 * kMotionSigma * source.gauss()();
  const Motion motion = motion_of(y);
  REQUIRE(motion.moving_s.size() == 1);
  CHECK(std::abs(motion.moving_s[0].low - 80) < 10);
  CHECK(std::abs(motion.moving_s[0].high - 920) < 10);
  REQUIRE(motion.still_s.has_value());
  REQUIRE(motion.findings.size() == 1);
  CHECK(motion.findings[0].severity == Severity::bad);
}

TEST_CASE("motion: lines drawn through gaps and a link that hung are not the rest that others move against") {
  for (const double slope : {1e-3 * kMotionSigma, 1e-9 * kMotionSigma}) {
    test::NoiseSource source(kMotionSamples, kMotionRate, 37);
    std::vector<double> y = source.record(kMotionQ, kMotionB, kMotionK);
    for (std::size_t t = 40'001; t < 48'000; ++t) y[t] = y[t - 1] + slope;
    CHECK(motion_of(y).moving_s.empty());
  }
}

TEST_CASE("motion: a recording in motion throughout is called one") {
  test::NoiseSource source(kMotionSamples, kMotionRate, 34);
  std::vector<double> y = source.record(kMotionQ, kMotionB, kMotionK);
  // A hand's movement: an oscillation of 1 Hz whose logarithm of amplitude wanders.
  double strength = 0;
  for (std::size_t t = 0; t < y.size(); ++t) {
    strength += -strength * 0.001 + 0.05 * source.gauss()();
    y[t] +=
        20 * kMotionSigma * std::exp(strength) * std::sin(2 * std::numbers::pi * static_cast<double>(t) / kMotionRate);
  }
  const Motion motion = motion_of(y);
  CHECK(motion.whole);
  CHECK_FALSE(motion.still_s.has_value());
  REQUIRE(motion.findings.size() == 1);
}

TEST_CASE("motion: signals from formulas are judged without a fit that cannot be") {
  std::vector<double> ramp(kMotionSamples), turns(kMotionSamples);
  for (std::size_t t = 0; t < kMotionSamples; ++t) {
    ramp[t] = static_cast<double>(t);
    turns[t] = t % 2 == 0 ? 1 : -1;
  }
  CHECK(motion_of(ramp).changes.empty());
  CHECK(motion_of(turns).changes.empty());
}

TEST_CASE("motion: a staircase and a short record are not judged") {
  test::NoiseSource source(kMotionSamples, kMotionRate, 35);
  std::vector<double> y = source.record(kMotionQ, kMotionB, kMotionK);
  for (double& value : y) value = std::round(value / (6 * kMotionSigma)) * 6 * kMotionSigma;
  CHECK_FALSE(motion_of(y).tested);
  y.resize(1000);
  CHECK_FALSE(motion_of(y).tested);
}

TEST_CASE("motion: a gyroscope that was turned by hand lay still for 39 s before") {
  NEEDS_SHARED("data/tilt_broad_02_undisturbed_slow_rotation_B.npy");
  const test::Array array = test::npy(test::shared("data/tilt_broad_02_undisturbed_slow_rotation_B.npy"));
  const std::optional<Interval> still = find_motion(event_series(array.column(2), 2000 / 7.0)).still_s;
  REQUIRE(still.has_value());
  CHECK(still->low == 0);
  CHECK(still->high == Approx(39).margin(1));
}

TEST_CASE("motion: six axes at rest for three hours are at rest, but for steps that they share") {
  NEEDS_SHARED("data/static_adis16405_run1.npy");
  const test::Array array = test::npy(test::shared("data/static_adis16405_run1.npy"));
  for (std::size_t axis = 0; axis < 6; ++axis) {
    INFO("axis " << axis);
    const EventSeries series = event_series(array.column(axis), 100);
    const Motion motion = find_motion(series);
    CHECK_FALSE(motion.whole);
    CHECK(motion.moving_s.empty());
    const EventSearch found = find_events(series, fitted_powers());
    if (axis < 3) {
      CHECK(found.events.empty());
      continue;
    }
    // Somebody stood beside the table for 25 s.
    const auto near = [&](double at_s) {
      return std::any_of(found.events.begin(), found.events.end(), [&](const Event& event) {
        return event.kind == EventKind::step && std::abs(event.at_s - at_s) < 1;
      });
    };
    CHECK(near(2153.7));
    CHECK(near(2178.4));
  }
}

#include "libchar/fit/signs/temperature.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "libchar/core/error.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/weather.hpp"

using namespace libchar;
using test::add_effect;
using test::weather;
using test::Weather;

namespace {

constexpr double kWarmRate = 10;
constexpr std::size_t kWarmSamples = 40'000;
constexpr double kWarmQ = 5e-3, kWarmB = 5e-3;

}  // namespace

TEST_CASE("temperature: a record that it does not move is left alone") {
  // 3 of 1200 in a longer run (docs/theory/events.md); 1 % is promised.
  int alarms = 0;
  for (const Weather kind : {Weather::drifting, Weather::daily, Weather::warming, Weather::cycling}) {
    test::NoiseSource source(kWarmSamples, kWarmRate, 107 + static_cast<unsigned>(kind));
    for (const double k : {0.0, 1e-3}) {
      for (int i = 0; i < 10; ++i) {
        const std::vector<double> y = source.record(kWarmQ, kWarmB, k);
        const TemperatureEffect found =
            find_temperature_effect(y, kWarmRate, weather(kind, kWarmSamples, source.gauss()));
        alarms += found.order > 0 ? 1 : 0;
        CHECK((found.order > 0) == !found.value.empty());
      }
    }
  }
  CHECK(alarms <= 3);
}

TEST_CASE("temperature: what it does is found with its lag, and the walk stays whole") {
  test::NoiseSource source(kWarmSamples, kWarmRate, 171);
  constexpr double kWalk = 5e-4;
  double clean = 0, with = 0, without = 0;
  int covered = 0, lag_covered = 0;
  constexpr int kRecords = 8;
  for (int i = 0; i < kRecords; ++i) {
    std::vector<double> y = source.record(kWarmQ, kWarmB, kWalk);
    FitOptions options;
    options.second_opinion = false;
    clean += fit_record(y, kWarmRate, nullptr, options).theta[2];
    const TemperatureRecord t = weather(Weather::daily, kWarmSamples, source.gauss());
    add_effect(y, t, kWarmRate, 60, 0.02);
    options.unit = "deg/s";
    const NoiseFit fit = fit_record(y, kWarmRate, nullptr, options, nullptr, {&t, nullptr, {}});
    REQUIRE(fit.temperature.has_value());
    const TemperatureEffect& effect = *fit.temperature;
    REQUIRE(effect.order >= 1);
    CHECK(effect.coefficient[0] == Approx(0.02).epsilon(0.3));
    covered += effect.ci95.low <= 0.02 && 0.02 <= effect.ci95.high ? 1 : 0;
    lag_covered += effect.lag_ci95.low <= 60 && 60 <= effect.lag_ci95.high ? 1 : 0;
    with += fit.theta[2];
    without += std::pow(effect.without[2].value.value_or(0), 2);
    CHECK(fit.remedies.back().kind == "temperature");
    CHECK(std::any_of(fit.findings.begin(), fit.findings.end(),
                      [](const Finding& s) { return s.sentence.find("With temperature left in, K would be") == 0; }));
  }
  CHECK(covered >= kRecords - 1);
  CHECK(lag_covered >= kRecords - 1);
  CHECK(std::sqrt(with / clean) == Approx(1).margin(0.12));
  CHECK(without > 1.5 * with);
}

TEST_CASE("temperature: a curve about the mean temperature has order 2") {
  test::NoiseSource source(kWarmSamples, kWarmRate, 173);
  std::vector<double> y = source.record(kWarmQ, kWarmB, 0);
  const TemperatureRecord t = weather(Weather::daily, kWarmSamples, source.gauss());
  add_effect(y, t, kWarmRate, 0, 0, 0.004);
  const TemperatureEffect effect = find_temperature_effect(y, kWarmRate, t);
  REQUIRE(effect.order == 2);
  CHECK(effect.coefficient[1] == Approx(0.004).epsilon(0.1));
  CHECK(effect.ci95.low < 0);
  CHECK(effect.ci95.high > 0);
}

TEST_CASE("temperature: a step of the sensor beside it is a step") {
  test::NoiseSource source(kWarmSamples, kWarmRate, 174);
  std::vector<double> y = source.record(kWarmQ, kWarmB, 0);
  const TemperatureRecord t = weather(Weather::daily, kWarmSamples, source.gauss());
  add_effect(y, t, kWarmRate, 0, 0.02);
  for (std::size_t i = kWarmSamples / 3; i < kWarmSamples; ++i) y[i] += 0.1;
  FitOptions options;
  options.second_opinion = false;
  const NoiseFit fit = fit_record(y, kWarmRate, nullptr, options, nullptr, {&t, nullptr, {}});
  REQUIRE(fit.temperature->order >= 1);
  CHECK(fit.temperature->coefficient[0] == Approx(0.02).epsilon(0.1));
  REQUIRE(fit.events.size() == 1);
  CHECK(fit.events[0].kind == EventKind::step);
  CHECK(fit.events[0].size == Approx(0.1).epsilon(0.15));
}

TEST_CASE("temperature: a slow thermometer, taking out and putting in again") {
  test::NoiseSource source(kWarmSamples, kWarmRate, 175);
  std::vector<double> y = source.record(kWarmQ, kWarmB, 0);
  TemperatureRecord t = weather(Weather::daily, kWarmSamples, source.gauss());
  add_effect(y, t, kWarmRate, 0, 0.02);
  const TemperatureEffect each = find_temperature_effect(y, kWarmRate, t);
  for (std::size_t i = 0; i < kWarmSamples; ++i)
    if (i % 50 != 7) t.samples[i] = std::numeric_limits<double>::quiet_NaN();
  const TemperatureEffect slow = find_temperature_effect(y, kWarmRate, t);
  REQUIRE(slow.order >= 1);
  CHECK(slow.coefficient[0] == Approx(each.coefficient[0]).epsilon(0.02));
  std::vector<double> back = y;
  add_temperature_effect(slow, -1, back);
  add_temperature_effect(slow, 1, back);
  for (std::size_t i = 0; i < kWarmSamples; i += 97) CHECK(back[i] == Approx(y[i]).margin(1e-12));
}

TEST_CASE("temperature: one that says nothing is refused in a sentence") {
  test::NoiseSource source(kWarmSamples, kWarmRate, 176);
  const std::vector<double> y = source.record(kWarmQ, 0, 0);
  TemperatureRecord t = weather(Weather::ramp, kWarmSamples, source.gauss());
  const auto what = [&] {
    try {
      find_temperature_effect(y, kWarmRate, t);
    } catch (const Error& error) {
      return error.problem().what;
    }
    return std::string();
  };
  for (std::size_t i = 10'000; i < 20'000; ++i) t.samples[i] = std::numeric_limits<double>::quiet_NaN();
  CHECK(what().find("is missing for 16.7 min from 1000 s on") != std::string::npos);
  t.samples.assign(kWarmSamples, 21.5);
  CHECK(what().find("is constant, 21.5 throughout") != std::string::npos);
  t.samples.assign(kWarmSamples, std::numeric_limits<double>::quiet_NaN());
  CHECK(what().find("has 0 values") != std::string::npos);
}

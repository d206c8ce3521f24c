#include "libchar/fit/signs/digital.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "libchar/fit/signs/rounding.hpp"
#include "tests/support/digital.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/npy.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

constexpr double kDigitalRate = 100, kSigma = 0.05;
constexpr std::size_t kDigitalSamples = 50'000;

std::vector<double> noise(std::uint64_t seed) {
  return test::NoiseSource(kDigitalSamples, kDigitalRate, seed).record(5e-3, 5e-3, 1.5e-3);
}

std::vector<double> rounded(std::vector<double> y, double step) {
  for (double& value : y) value = std::round(value / step) * step;
  return y;
}

}  // namespace

TEST_CASE("digital: noise has no rails, no held values and no staircase, also when rounded") {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    std::vector<double> y = noise(seed);
    y[77] = std::numeric_limits<double>::quiet_NaN();
    CHECK(test::digital_faults(y, kDigitalRate).findings.empty());
    for (const double step : {0.01, 0.1, 0.3, 0.7}) {
      INFO("seed " << seed << ", step " << step);
      CHECK(test::digital_faults(rounded(y, step * kSigma), kDigitalRate, step * kSigma).findings.empty());
    }
  }
}

TEST_CASE("digital: truncation towards zero is a dead band") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    for (const double step : {0.05, 0.2, 0.5}) {
      INFO("seed " << seed << ", step " << step);
      std::vector<double> y = noise(seed);
      for (double& value : y) value = std::trunc(value / (step * kSigma)) * (step * kSigma);
      const auto found = test::digital_faults(y, kDigitalRate, step * kSigma).findings;
      REQUIRE(found.size() == 1);
      CHECK(found[0].code == "dead_band");
      CHECK(found[0].severity == Severity::caution);
      for (double& value : y) value += 10 * kSigma;
      CHECK(test::digital_faults(y, kDigitalRate, step * kSigma).findings.empty());
    }
}

TEST_CASE("digital: two levels, a counter and a lone spike have no rails") {
  std::vector<double> square(kDigitalSamples), counter(kDigitalSamples), spike(kDigitalSamples, 1.0);
  for (std::size_t t = 0; t < kDigitalSamples; ++t) {
    square[t] = t / 500 % 2 == 0 ? 1 : -1;
    counter[t] = static_cast<double>(t % 256);
  }
  spike[777] = 5;
  CHECK(test::digital_faults(square, kDigitalRate).rails.empty());
  CHECK(test::digital_faults(counter, kDigitalRate).rails.empty());
  CHECK(test::digital_faults(spike, kDigitalRate).rails.empty());
}

TEST_CASE("digital: samples at a rail are counted, on a grid and off it") {
  std::vector<double> y = noise(40);
  for (double& value : y) value = std::clamp(value, -1.9 * kSigma, 2.2 * kSigma);
  const auto clipped = static_cast<double>(std::count(y.begin(), y.end(), 2.2 * kSigma));
  const DigitalFaults faults = test::digital_faults(y, kDigitalRate, {}, "deg/s");
  REQUIRE(faults.rails.size() == 2);
  CHECK_FALSE(faults.rails[0].high);
  CHECK(faults.rails[1].value == 2.2 * kSigma);
  CHECK(faults.rails[1].share == Approx(clipped / kDigitalSamples));
  CHECK(faults.findings[1].sentence.find("are at the largest value, 0.110 deg/s") != std::string::npos);

  std::vector<double> one = noise(41);
  for (double& value : one) value = std::min(value, 2 * kSigma);
  const DigitalFaults coarse = test::digital_faults(rounded(one, 0.1 * kSigma), kDigitalRate, 0.1 * kSigma);
  REQUIRE(coarse.rails.size() == 1);
  CHECK(coarse.rails[0].high);
}

TEST_CASE("digital: values that are recorded several times") {
  const std::vector<double> sensor = noise(42);
  for (const double times : {2.0, 3.0, 2.4, 1.5, 1.2}) {
    for (const double step : {0.0, 0.2}) {
      std::vector<double> y(kDigitalSamples);
      for (std::size_t t = 0; t < y.size(); ++t)
        y[t] = sensor[static_cast<std::size_t>(static_cast<double>(t) / times)];
      if (step > 0) y = rounded(y, step * kSigma);
      INFO("times " << times << ", step " << step);
      const DigitalFaults faults = test::digital_faults(y, kDigitalRate);
      // Rounding makes neighbours equal by chance: what is held less than twice is then not told from it.
      if (step > 0 && times < 2) continue;
      REQUIRE(faults.held.has_value());
      CHECK(faults.held->times == Approx(times).epsilon(step > 0 ? 0.1 : 1e-3));
      CHECK(faults.held->sensor_rate_hz == Approx(kDigitalRate / faults.held->times));
    }
  }
}

TEST_CASE("digital: a converter's step above the noise") {
  const std::vector<double> y = test::NoiseSource(kDigitalSamples, kDigitalRate, 43).record(5e-3, 0, 1e-2);
  for (const double ratio : {1.5, 2.5}) {
    const double step = ratio * kSigma;
    const DigitalFaults faults = test::digital_faults(rounded(y, step), kDigitalRate, step);
    INFO("step " << ratio << " sigma");
    REQUIRE(faults.staircase.has_value());
    CHECK_FALSE(faults.staircase->bounded);
    CHECK(faults.staircase->noise == Approx(kSigma).epsilon(0.1));
    CHECK(faults.rails.empty());
  }
  const DigitalFaults coarse = test::digital_faults(rounded(y, 10 * kSigma), kDigitalRate, 10 * kSigma);
  REQUIRE(coarse.staircase.has_value());
  CHECK(coarse.staircase->bounded);
}

TEST_CASE("digital: what rounding adds is known no better than where between two steps the value stands") {
  for (const double sigma : {0.25, 0.3, 0.4, 0.45, 0.6, 0.8})
    for (const double stands : {0.0, 0.25, 0.5}) {
      std::vector<double> y = test::NoiseSource(kDigitalSamples, 1, 44).record(sigma, 0, 0);
      for (double& value : y) value = std::round(value + stands);
      const DigitalFaults faults = test::digital_faults(y, 1, 1);
      if (!faults.rounding) continue;
      double mean = 0, square = 0;
      for (const double value : y) mean += value / static_cast<double>(y.size());
      for (const double value : y) square += (value - mean) * (value - mean) / static_cast<double>(y.size());
      INFO("noise of " << sigma << " steps at " << stands << " steps");
      const DigitalFaults::Rounding& rounding = *faults.rounding;
      CHECK(std::fabs(square - rounding.variance - sigma * sigma) < 2.5 * rounding.sd + 0.01);
      if (sigma > 0.5) CHECK(rounding.sd < 0.01);
    }
}

TEST_CASE("digital: counts are skewed, and rounded Gaussian noise is not") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 engine(seed);
    for (const double rate : {1.0, 4.0}) {
      std::poisson_distribution<int> count(rate);
      std::vector<double> y(kDigitalSamples);
      for (double& value : y) value = count(engine);
      const DigitalFaults faults = test::digital_faults(y, kDigitalRate, 1);
      CAPTURE(seed, rate);
      REQUIRE(faults.rounding);
      CHECK(faults.rounding->of_counts);
    }
    // Skewed less than counts, however clearly: a squared share of the noise.
    std::vector<double> bent = noise(seed);
    for (double& value : bent) value += 0.02 * value * value / kSigma;
    const DigitalFaults less = test::digital_faults(rounded(bent, 0.8 * kSigma), kDigitalRate, 0.8 * kSigma);
    REQUIRE(less.rounding);
    CHECK(!less.rounding->of_counts);
    for (const double step : {0.3, 0.7, 1.2}) {
      const DigitalFaults faults =
          test::digital_faults(rounded(noise(seed), step * kSigma), kDigitalRate, step * kSigma);
      CAPTURE(seed, step);
      REQUIRE(faults.rounding);
      CHECK(!faults.rounding->of_counts);
    }
  }
}

TEST_CASE("digital: a clean recording of a real sensor") {
  NEEDS_SHARED("data/static_adis16405_run1.npy");
  const test::Array array = test::npy(test::shared("data/static_adis16405_run1.npy"));
  for (std::size_t axis = 0; axis < 6; ++axis) {
    INFO("axis " << axis);
    const DigitalFaults faults = test::digital_faults(array.column(axis), 100, axis < 3 ? 0.05 : 1.0 / 300);
    CHECK(faults.rails.empty());
    CHECK_FALSE(faults.held.has_value());
  }
}

TEST_CASE("a counter of coarse steps hides what a clock does between its readings") {
  const auto said = [](std::uint64_t repeats, std::optional<double> step) {
    ValueCensus census;
    census.low = 0, census.high = 400, census.repeats = repeats;
    const auto found = detail::find_coarse_counter(census, 10000, step, "ns");
    return found ? found->code + ": " + found->sentence : "";
  };
  CHECK(said(9900, 4) ==
        "staircase: 99 % of the readings repeat the one before: the counter's step of 4.00 ns hides "
        "what the clock does between samples, and short averaging times show its rounding.");
  CHECK(said(1000, 4).empty());  // rounding that is noise
  CHECK(said(9900, std::nullopt).empty());
}

namespace {

NoiseFit white_fit(double value, double relative_sd, Interval ci95) {
  NoiseFit fit;
  fit.rate_hz = 1;
  Coefficient& white = fit.term[static_cast<std::size_t>(Term::white)];
  white.status = Status::detected;
  white.value = value;
  white.relative_sd = relative_sd;
  white.ci95 = ci95;
  fit.theta[static_cast<std::size_t>(Term::white)] = value * value;
  return fit;
}

}  // namespace

TEST_CASE("digital: rounding hides white noise only where it is a part of it") {
  const auto after = [](double variance) {
    NoiseFit fit = white_fit(0.1, 0.3, {0, 0.2});
    detail::take_out_rounding({1e-5, variance, 0, false}, fit);
    return fit[Term::white];
  };
  CHECK(after(1e-11).status == Status::detected);
  CHECK(*after(1e-11).value == Approx(0.1));
  CHECK(after(1e-11).ci95.low == 0);
  CHECK(after(0.009).status == Status::not_detected);
}

TEST_CASE("digital: of counts no rounding is taken out, and the interval holds N without it") {
  NoiseFit fit = white_fit(2, 0.005, {1.98, 2.02});
  detail::take_out_rounding({1, 1.0 / 12, 0, true}, fit);
  const Coefficient white = fit[Term::white];
  CHECK(*white.value == 2);
  CHECK(white.ci95.low == Approx(std::sqrt(1.98 * 1.98 - 1.0 / 12)));
  CHECK(white.ci95.high == 2.02);
  CHECK(fit.rounding == 0);
  CHECK(fit.findings.size() == 1);
}

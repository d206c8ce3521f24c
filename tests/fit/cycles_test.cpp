#include "libchar/fit/detail/record/cycles.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "libchar/core/finding.hpp"
#include "libchar/core/numeric/moments.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "libchar/spectrum/fft.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

constexpr double kCycleRate = 100;
constexpr double kWhiteOfCycles = 5e-3;

/// A heating of two states behind a slow wall: period and height.
std::vector<double> heating(std::size_t n, double period_s, double height) {
  std::vector<double> y(n);
  double wall = 0;
  for (std::size_t t = 0; t < n; ++t) {
    const bool on = std::fmod(static_cast<double>(t) / kCycleRate, period_s) < 0.47 * period_s;
    wall += ((on ? height : 0) - wall) / (kCycleRate * period_s / 10);
    y[t] = wall;
  }
  return y;
}

NoiseFit fit_of(const std::vector<double>& y) {
  FitOptions options;
  options.second_opinion = false;
  return fit_record(y, kCycleRate, nullptr, options);
}

double sd_of(const std::vector<double>& y) {
  Moments moments;
  moments.push(y);
  return moments.standard_deviation();
}

bool says_cycle(const NoiseFit& fit) {
  return std::any_of(fit.findings.begin(), fit.findings.end(), [](const Finding& one) { return one.code == "cycle"; });
}

bool within(const Coefficient& white) { return white.ci95.low <= kWhiteOfCycles && kWhiteOfCycles <= white.ci95.high; }

}  // namespace

TEST_CASE("cycles: a sine between two coefficients is taken out to the last digit") {
  constexpr std::size_t kPoints = 5000;
  std::vector<double> y(kPoints);
  for (std::size_t t = 0; t < kPoints; ++t)
    y[t] = 3 * std::cos(std::numbers::pi * 23.37 * (static_cast<double>(t) + 0.5) / kPoints + 0.4);
  Dct plan(kPoints);
  const auto c = plan.transform(y);
  std::vector<double> rest(c.begin(), c.end());
  const auto cycles = detail::take_out_cycles(rest, kPoints);
  REQUIRE_FALSE(cycles.empty());
  CHECK(cycles[0].place == Approx(23.37).margin(1e-4));
  CHECK(cycles[0].amplitude == Approx(3).epsilon(1e-4));
  CHECK(cycles[0].phase == Approx(-0.4).margin(1e-3));
  for (std::size_t k = 1; k < rest.size(); ++k) CHECK(std::abs(rest[k]) < 0.1);
}

TEST_CASE("cycles: a heating cycle is named, and B and K are not its") {
  constexpr std::size_t kSamples = 200'000;
  test::NoiseSource source(kSamples, kCycleRate, 341);
  for (const double period : {97.0, 260.0}) {
    for (const double height : {0.02, 0.3}) {
      std::vector<double> y = source.record(kWhiteOfCycles, 0, 0);
      const std::vector<double> wall = heating(kSamples, period, height);
      for (std::size_t t = 0; t < kSamples; ++t) y[t] += wall[t];
      const NoiseFit fit = fit_of(y);
      INFO(period << " s, height " << height);
      REQUIRE(says_cycle(fit));
      const auto one =
          std::find_if(fit.findings.begin(), fit.findings.end(), [](const Finding& f) { return f.code == "cycle"; });
      CHECK(1 / one->where.frequency_hz[0].low == Approx(period).epsilon(0.01));
      std::vector<double> left = wall;
      const double before = sd_of(left);
      subtract_events(fit.cycles, kCycleRate, left);
      CHECK(sd_of(left) < (height > 0.1 ? 0.02 : 0.2) * before);
      CHECK(within(fit[Term::white]));
      CHECK(fit[Term::flicker].status == Status::not_detected);
      CHECK(fit[Term::walk].status == Status::not_detected);
    }
  }
}

TEST_CASE("cycles: in a short record a sine as strong as the noise leaves N") {
  const double sd = kWhiteOfCycles * std::sqrt(kCycleRate);
  int held = 0, detected = 0, records = 0;
  for (const std::size_t n : {std::size_t{500}, std::size_t{1000}})
    for (const double cycles : {7.0, 12.6, 30.2})
      for (unsigned seed = 0; seed < 10; ++seed, ++records) {
        std::mt19937_64 engine(400 + seed);
        std::normal_distribution<double> normal;
        std::vector<double> y(n);
        for (std::size_t t = 0; t < n; ++t)
          y[t] =
              sd * (normal(engine) +
                    std::sin(2 * std::numbers::pi * cycles * static_cast<double>(t) / static_cast<double>(n) + seed));
        const NoiseFit fit = fit_of(y);
        held += within(fit[Term::white]);
        detected += fit[Term::white].status == Status::detected;
      }
  INFO(held << " held and " << detected << " detected of " << records);
  CHECK(held >= 54);
  CHECK(detected >= 57);
}

TEST_CASE("cycles: a heating without a steady period leaves N, and limits of B and K") {
  constexpr std::size_t kSamples = 300'000;
  test::NoiseSource source(kSamples, kCycleRate, 345);
  test::Gaussian draw(346);
  int right = 0;
  constexpr int kRecords = 6;
  for (int r = 0; r < kRecords; ++r) {
    std::vector<double> y = source.record(kWhiteOfCycles, 0, 0);
    double wall = 0, left_s = 0;
    bool on = false;
    for (std::size_t t = 0; t < kSamples; ++t) {
      if ((left_s -= 1 / kCycleRate) < 0) {
        on = !on;
        left_s = 120 + 15 * draw();
      }
      wall += ((on ? 0.05 : 0) - wall) / (kCycleRate * 30);
      y[t] += wall;
    }
    const NoiseFit fit = fit_of(y);
    const auto hump = std::find_if(fit.findings.begin(), fit.findings.end(),
                                   [](const Finding& f) { return f.code == "hump" || f.code == "cycle"; });
    right +=
        hump != fit.findings.end() && within(fit[Term::white]) && !fit[Term::flicker].value && !fit[Term::walk].value
            ? 1
            : 0;
  }
  CHECK(right >= kRecords - 1);
}

TEST_CASE("cycles: noise of every colour, steps and warm-ups have none") {
  constexpr std::size_t kSamples = 20'000;
  test::NoiseSource source(kSamples, kCycleRate, 342);
  int said = 0;
  for (int r = 0; r < 60; ++r) {
    std::vector<double> y = source.record(kWhiteOfCycles, r % 3 == 1 ? 0.05 : 0, r % 3 == 2 ? 0.1 : 0);
    if (r % 4 == 1)
      for (std::size_t t = kSamples / 3; t < kSamples; ++t) y[t] += 0.5;
    if (r % 4 == 2)
      for (std::size_t t = 0; t < kSamples; ++t) y[t] += 2 * std::exp(-static_cast<double>(t) / 3000);
    said += says_cycle(fit_of(y)) ? 1 : 0;
  }
  CHECK(said == 0);
}

TEST_CASE("cycles: a shift changes nothing, a scale scales") {
  constexpr std::size_t kSamples = 100'000;
  test::NoiseSource source(kSamples, kCycleRate, 343);
  std::vector<double> y = source.record(kWhiteOfCycles, 0, 0);
  const std::vector<double> wall = heating(kSamples, 150, 0.1);
  for (std::size_t t = 0; t < kSamples; ++t) y[t] += wall[t];
  const NoiseFit fit = fit_of(y);
  for (double& v : y) v = 1000 * v + 16;
  const NoiseFit other = fit_of(y);
  CHECK(says_cycle(other));
  CHECK(*other[Term::white].value == Approx(1000 * *fit[Term::white].value).epsilon(1e-6));
}

namespace {

std::vector<double> slow_cycle(std::vector<double> y, double cycles, double amplitude, double phase) {
  for (std::size_t t = 0; t < y.size(); ++t)
    y[t] += amplitude *
            std::sin(2 * std::numbers::pi * cycles * static_cast<double>(t) / static_cast<double>(y.size()) + phase);
  return y;
}

}  // namespace

TEST_CASE("cycles: less than two periods in the record are no random walk") {
  constexpr std::size_t kSamples = 60'000;
  const double sd = kWhiteOfCycles * std::sqrt(kCycleRate);
  int records = 0, said = 0, walks = 0, held = 0, placed = 0;
  for (const double cycles : {1.0, 1.2, 1.5, 1.9, 2.3})
    for (const double times : {0.1, 1.0, 10.0})
      for (std::uint64_t seed = 0; seed < 4; ++seed, ++records) {
        test::NoiseSource source(kSamples, kCycleRate, 700 + seed);
        const double phase = 1.7 * static_cast<double>(seed) + cycles;
        const NoiseFit fit = fit_of(slow_cycle(source.record(kWhiteOfCycles, 0, 0), cycles, times * sd, phase));
        const auto one =
            std::find_if(fit.findings.begin(), fit.findings.end(), [](const Finding& f) { return f.code == "cycle"; });
        said += one != fit.findings.end();
        if (one != fit.findings.end())
          placed +=
              std::abs(one->where.frequency_hz[0].low * static_cast<double>(kSamples) / kCycleRate / cycles - 1) < 0.1;
        walks += fit[Term::walk].status == Status::detected;
        held += fit[Term::white].value && within(fit[Term::white]);
      }
  INFO(said << " said, " << placed << " placed, " << walks << " walks, " << held << " held of " << records);
  CHECK(said >= 52);  // the others, of a tenth of the noise, are a ramp or in doubt
  CHECK(placed >= 52);
  CHECK(walks <= 1);
  CHECK(held >= 54);
}

TEST_CASE("cycles: random walks, flicker and white noise hold no slow cycle") {
  constexpr std::size_t kSamples = 60'000;
  constexpr int kRecords = 40;
  int said = 0, detected = 0, white = 0;
  for (int seed = 0; seed < kRecords; ++seed) {
    test::NoiseSource source(kSamples, kCycleRate, 800 + static_cast<std::uint64_t>(seed));
    const NoiseFit walk = fit_of(source.record(kWhiteOfCycles, 0, 3e-3));
    said += says_cycle(walk) + says_cycle(fit_of(source.record(kWhiteOfCycles, 5e-3, 1e-3)));
    detected += walk[Term::walk].status == Status::detected;
    const NoiseFit plain = fit_of(source.record(kWhiteOfCycles, 0, 0));
    white += says_cycle(plain) + (plain[Term::walk].status == Status::detected);
  }
  INFO(said << " cycles, " << detected << " walks, " << white << " in white noise");
  CHECK(said <= 2);
  CHECK(detected >= kRecords - 4);
  CHECK(white <= 1);
}

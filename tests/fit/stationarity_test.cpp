// Noise that is the same throughout is left alone; noise that changes is told, with its place and its size.
#include "libchar/fit/signs/stationarity.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/fit/curve/shaped_curves.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

using test::Record;

constexpr double kSteadyRate = 100;
constexpr std::size_t kSteadySamples = 64'000;

Record clean(unsigned seed) {
  test::NoiseSource source(kSteadySamples, kSteadyRate, seed);
  return source.record(5e-3, 5e-3, 1.5e-3);
}

// White noise of more strength between two shares of the record.
Record louder_between(unsigned seed, double factor, double from, double to) {
  Record y = clean(seed);
  test::Gaussian normal(seed + 1000);
  const double added = 5e-3 * std::sqrt(kSteadyRate) * std::sqrt(factor * factor - 1);
  for (std::size_t t = 0; t < y.size(); ++t) {
    const double x = static_cast<double>(t) / static_cast<double>(y.size());
    if (x >= from && x < to) y[t] += added * normal();
  }
  return y;
}

// Factors of sixteen stretches with a standard deviation of ln of .06; `sd`: theirs.
Record wandering(unsigned seed, unsigned factors, double* sd = nullptr) {
  test::Gaussian normal(factors);
  double sum = 0, squares = 0;
  Record y = clean(seed);
  for (std::size_t s = 0; s < 16; ++s) {
    const double log_factor = 0.06 * normal();
    sum += log_factor;
    squares += log_factor * log_factor;
    for (std::size_t t = s * kSteadySamples / 16; t < (s + 1) * kSteadySamples / 16; ++t) y[t] *= std::exp(log_factor);
  }
  if (sd != nullptr) *sd = std::sqrt((squares - sum * sum / 16) / 15);
  return y;
}

Stationarity of(const Record& y) { return fit_record(y, kSteadyRate, nullptr).stationarity; }

}  // namespace

TEST_CASE("stationarity: a steady record is called unsteady in one of a hundred at most") {
  int unsteady = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const Stationarity found = of(clean(seed));
    REQUIRE(found.tested);
    // Octaves that fit a stretch, up to an eighth of a quarter of the record.
    CHECK(found.spread.front().tau_s == Approx(0.01));
    CHECK(found.spread.back().tau_s == Approx(10.24));
    unsteady += found.steady ? 0 : 1;
    if (found.steady) CHECK(found.sentence.empty());
  }
  CHECK(unsteady <= 3);
}

TEST_CASE("stationarity: a louder stretch is found, placed and sized") {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Stationarity found = of(louder_between(seed, 1.5, 0.25, 0.3125));
    REQUIRE_FALSE(found.steady);
    CHECK(found.noticeable);
    CHECK(found.largest_s.low == Approx(160));
    CHECK(found.largest_s.high == Approx(200));
    // Over the root mean square of all: sqrt((15 + 1.5²) / 16) is 1.038.
    CHECK(found.largest == Approx(1.5 / 1.038).epsilon(0.05));
    CHECK(found.sentence.find("(160 to 200 s)") != std::string::npos);
  }
}

TEST_CASE("stationarity: the spread is that of the stretches") {
  double sd = 0;
  const Record y = wandering(3, 5, &sd);
  const Stationarity found = of(y);
  REQUIRE_FALSE(found.steady);
  CHECK(found.spread[0].relative_sd == Approx(sd).epsilon(0.15));
  // Student's t of fifteen degrees of freedom, and the mean of sixteen.
  CHECK(spread_reach(found, 0.01) == Approx(2.1314 * std::sqrt(17.0 / 16) * found.spread[0].relative_sd).epsilon(1e-4));
  CHECK(spread_reach(found, 1e6) == spread_reach(found, found.spread.back().tau_s));
}

TEST_CASE("stationarity: the interval of a coefficient holds what stretches differ by, as the Allan curve's does") {
  const double long_run = 5e-3 * std::exp(0.06 * 0.06);
  int held = 0, held_as_steady = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Record y = wandering(seed, seed + 100);
    FitOptions as_steady;
    as_steady.stationarity = false;
    for (const bool steady : {false, true}) {
      const Coefficient n = fit_record(y, kSteadyRate, nullptr, steady ? as_steady : FitOptions{})[Term::white];
      const bool holds = n.ci95.low <= long_run && long_run <= n.ci95.high;
      (steady ? held_as_steady : held) += holds ? 1 : 0;
    }
  }
  CHECK(held >= 36);
  CHECK(held_as_steady <= 24);
}

TEST_CASE("stationarity: scale and offset change nothing, and time reversed is the same") {
  const Record y = louder_between(4, 1.2, 0.5, 1);
  const Stationarity found = of(y);
  REQUIRE_FALSE(found.steady);
  Record scaled = y, reversed(y.rbegin(), y.rend());
  for (double& x : scaled) x = 1e-12 * x + 3e-9;
  const Stationarity again = of(scaled), back = of(reversed);
  REQUIRE(again.spread.size() == found.spread.size());
  REQUIRE(back.spread.size() == found.spread.size());
  for (std::size_t i = 0; i < found.spread.size(); ++i) {
    CHECK(again.spread[i].relative_sd == Approx(found.spread[i].relative_sd).epsilon(1e-3).margin(1e-5));
    CHECK(back.spread[i].relative_sd == Approx(found.spread[i].relative_sd).epsilon(0.05).margin(0.01));
  }
}

TEST_CASE("stationarity: short, holed and constant records are not judged") {
  Record y = clean(1);
  CHECK_FALSE(of(Record(y.begin(), y.begin() + 8000)).tested);
  NoiseFit fit = fit_record(y, kSteadyRate, nullptr);
  CHECK(test_stationarity(y, kSteadyRate, fit).tested);
  for (std::size_t t = 0; t < y.size(); t += 8) y[t] = std::numeric_limits<double>::quiet_NaN();
  fit.samples = y.size() - (y.size() + 7) / 8;
  CHECK_FALSE(test_stationarity(y, kSteadyRate, fit).tested);
  fit.samples = y.size();
  CHECK_FALSE(test_stationarity(Record(20'000, 1.0), kSteadyRate, fit).tested);
  Record gap = clean(2);  // one missing stretch that holds whole pieces
  for (std::size_t t = 30'000; t < 34'000; ++t) gap[t] = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(test_stationarity(gap, kSteadyRate, fit).tested);
  FitOptions as_it_is;
  as_it_is.stationarity = false;
  CHECK_FALSE(fit_record(clean(1), kSteadyRate, nullptr, as_it_is).stationarity.tested);
}

TEST_CASE("stationarity: the intervals of a curve hold what stretches differ by") {
  // White noise whose strength changes every twentieth of the record.
  int covered = 0, wider = 0;
  constexpr int kRecords = 30;
  constexpr double kSpread = 0.3;  // of ln
  for (unsigned seed = 0; seed < kRecords; ++seed) {
    test::Gaussian normal(seed + 50);
    Record y(kSteadySamples);
    double level = 1;
    for (std::size_t t = 0; t < y.size(); ++t) {
      if (t % (kSteadySamples / 20) == 0) level = std::exp(kSpread * normal());
      y[t] = level * normal();
    }
    const NoiseFit fit = fit_record(y, kSteadyRate, nullptr);
    AllanCurve curve = pyramid_deviation(y, 1 / kSteadyRate);
    add_fit_intervals(curve, fit);
    const AllanPoint& point = curve.points.at(2);
    const double truth = std::exp(kSpread * kSpread) / std::sqrt(4.0);
    covered += point.ci95.low <= truth && truth <= point.ci95.high ? 1 : 0;
    wider += point.edf < 1000 ? 1 : 0;
    CHECK(curve.notes.size() == (fit.stationarity.steady ? 0 : 1));
  }
  CAPTURE(covered, wider);
  CHECK(covered >= 24);
  CHECK(wider >= 28);
}

#include "libchar/replay/error_meter.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numeric>

#include "libchar/core/numeric/median.hpp"
#include "libchar/simulate/detail/noise_generator.hpp"
#include "libchar/simulate/random.hpp"

using namespace libchar;

namespace {

// Errors with correlation `memory` from sample to sample, unit variance.
std::vector<double> errors(std::size_t n, double memory, std::uint64_t seed) {
  DeviateStream normal({seed, 0, Purpose::truth});
  std::vector<double> e(n);
  double state = normal.normal();
  for (double& value : e) {
    value = state;
    state = memory * state + std::sqrt(1 - memory * memory) * normal.normal();
  }
  return e;
}

ErrorMeter metered(const std::vector<double>& e, std::size_t block = 1000) {
  ErrorMeter meter;
  for (std::size_t at = 0; at < e.size(); at += block)
    meter.push(std::span(e).subspan(at, std::min(block, e.size() - at)));
  return meter;
}

}  // namespace

TEST_CASE("scores: known sums") {
  const ErrorScore s = score(metered({3, -4, std::nan(""), 0, 5}), 1);
  CHECK(s.rmse == Approx(std::sqrt(50.0 / 4)));
  CHECK(s.bias == Approx(1));
  CHECK(s.maximum == 5);
  CHECK(s.availability == Approx(0.8));
  CHECK(s.samples == 4);
  CHECK(std::isnan(score(metered({std::nan("")}), 1).rmse));
  CHECK(score(ErrorMeter(), 1).availability == 0);
}

TEST_CASE("scores: neither the block size nor the merging of cells changes the sums") {
  const auto e = errors(100003, 0.9, 1);
  const ErrorScore a = score(metered(e, 1), 10), b = score(metered(e, 4097), 10);
  CHECK(a.rmse == b.rmse);
  CHECK(a.rmse_ci95.low == b.rmse_ci95.low);
  double squares = 0;
  for (const double v : e) squares += v * v;
  CHECK(a.rmse == Approx(std::sqrt(squares / 100003)).epsilon(1e-12));
  CHECK(metered(e).cells().size() <= 4096);
}

namespace {

int covering(double truth, int records, const std::function<std::vector<double>(std::uint64_t)>& error) {
  int covered = 0;
  for (int seed = 1; seed <= records; ++seed) {
    const ErrorScore s = score(metered(error(static_cast<std::uint64_t>(seed))), 1);
    covered += s.stationary && s.rmse_ci95.low <= truth && truth <= s.rmse_ci95.high;
  }
  return covered;
}

std::vector<double> of_design(const Mixture& coefficients, std::uint64_t seed) {
  NoiseDesign design;
  design.coefficient = coefficients;
  design.rate_hz = 1;
  std::vector<double> e(16384, 0.0);
  NoiseGenerator(design, seed, 0).add(e, {});
  return e;
}

double expected_rms(const Mixture& coefficients) {
  double squares = 0;
  for (std::uint64_t seed = 1001; seed <= 1300; ++seed)
    for (const double e : of_design(coefficients, seed)) squares += e * e;
  return std::sqrt(squares / (300 * 16384));
}

}  // namespace

TEST_CASE("scores: intervals cover for errors without, with short and with endless correlation") {
  for (const double memory : {0.0, 0.9, 0.98}) {
    CAPTURE(memory);
    const int covered = covering(1, 200, [&](std::uint64_t seed) { return errors(20000, memory, seed); });
    CHECK(covered >= 180);
    CHECK(covered < 200);
  }
  for (const Mixture& noise : {Mixture{0, 1, 0, 0, 0}, Mixture{3, 1, 0, 0, 0}}) {
    const int covered = covering(expected_rms(noise), 200, [&](std::uint64_t seed) { return of_design(noise, seed); });
    CAPTURE(noise[0], covered);
    CHECK(covered >= 174);  // 180 of those that have one; a few flicker records look like a walk
  }
}

TEST_CASE("scores: intervals of errors that never end are about as wide as other records differ") {
  // Without the record's own mean, as noise made by a Fourier transform is, they were more than four times as wide.
  const Mixture flicker{0, 1, 0, 0, 0};
  for (const bool centred : {false, true}) {
    std::vector<double> logs, reaches;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
      std::vector<double> e = of_design(flicker, seed);
      const double mean = std::accumulate(e.begin(), e.end(), 0.0) / static_cast<double>(e.size());
      for (double& one : e) one -= centred ? mean : 0;
      const ErrorScore s = score(metered(e), 1);
      logs.push_back(std::log(s.rmse));
      if (s.stationary) reaches.push_back(std::log(s.rmse_ci95.high / s.rmse_ci95.low) / 2);
    }
    const double middle = std::accumulate(logs.begin(), logs.end(), 0.0) / 100;
    double squares = 0;
    for (const double one : logs) squares += (one - middle) * (one - middle);
    CHECK(median_in_place(reaches) < (centred ? 3.5 : 1.1) * 1.96 * std::sqrt(squares / 99));
  }
}

TEST_CASE("scores: an error that walks or drifts has no interval, and one that does not has") {
  int walks = 0, none = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const ErrorScore s = score(metered(of_design({0, 0, 1, 0, 0}, seed)), 1);
    walks += s.stationary;
    CHECK(std::isnan(s.rmse_ci95.low) == !s.stationary);
    none += !score(metered(of_design({1, 0, 0, 0, 0}, seed)), 1).stationary;
  }
  CHECK(walks <= 2);
  CHECK(none == 0);
  auto drift = errors(20000, 0, 1);
  for (std::size_t i = 0; i < drift.size(); ++i) drift[i] += 1e-3 * static_cast<double>(i);
  CHECK_FALSE(score(metered(drift), 1).stationary);
}

TEST_CASE("scores: of several sensors each counts alike") {
  const ErrorMeter small = metered(errors(5000, 0, 1)), large = [] {
    auto e = errors(5000, 0, 2);
    for (double& v : e) v *= 100;
    return metered(e);
  }();
  const GeometricRms both = geometric_rms({&small, &large});
  CHECK(both.rms == Approx(10).epsilon(0.03));
  CHECK(both.ci95.low < 10);
  CHECK(both.ci95.high > 10);
  CHECK(both.ci95.high / both.ci95.low < 1.06);
  CHECK(std::isnan(geometric_rms({}).rms));
}

TEST_CASE("scores: a difference is resolved when there is one") {
  const auto e = errors(20000, 0.9, 1), other = errors(20000, 0.9, 2);
  std::vector<double> worse = e;
  for (std::size_t i = 0; i < worse.size(); ++i) worse[i] = 1.02 * e[i] + 0.01 * other[i];
  // Paired: a 2 % difference between errors that go together shows, where each interval alone is wider.
  const ErrorMeter bad = metered(worse), good = metered(e), third = metered(errors(20000, 0.9, 3));
  const Interval paired = rms_ratio_interval({&bad}, {&good});
  CHECK(paired.low > 1.015);
  CHECK(paired.high < 1.025);
  const Interval apart = rms_ratio_interval({&third}, {&good});
  CHECK(apart.low < 1);
  CHECK(apart.high > 1);
}

TEST_CASE("scores: a spike hides the ratio of errors, and not that one is larger throughout") {
  auto e = errors(20000, 0.5, 1);
  std::vector<double> worse = e;
  for (double& v : worse) v *= 1.3;
  e[700] = 1e9;
  worse[700] = 1.001e9;
  const ErrorMeter bad = metered(worse), good = metered(e), same = metered(errors(20000, 0.5, 2));
  CHECK(rms_ratio_interval({&bad}, {&good}).low < 1.01);
  CHECK(larger_throughout({&bad}, {&good}) < 1e-4);
  CHECK(larger_throughout({&good}, {&bad}) == 1);
  CHECK(larger_throughout({&good}, {&good}) == 1);
  // Equal by nature: no more often than it says.
  int alarms = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const ErrorMeter a = metered(errors(4000, 0.5, seed)), b = metered(errors(4000, 0.5, 1000 + seed));
    alarms += larger_throughout({&a}, {&b}) < 0.01;
  }
  CHECK(alarms <= 6);
  CHECK(larger_throughout({}, {&same}) == 1);
}

TEST_CASE("scores: convergence is the end of the transient") {
  auto e = errors(40000, 0, 1);
  for (std::size_t i = 0; i < 8000; ++i) e[i] *= 5;
  CHECK(score(metered(e), 100).converged_s == Approx(80).margin(8));
  CHECK(score(metered(errors(40000, 0, 1)), 100).converged_s == Approx(0).margin(1));
  for (double& v : e) v = 1;
  for (std::size_t i = 0; i < e.size(); ++i) e[i] = static_cast<double>(e.size() - i);
  CHECK(std::isnan(score(metered(e), 100).converged_s));
}

TEST_CASE("error meter: the deviation is what is left beside a constant") {
  ErrorMeter meter;
  const std::vector<double> errors{3, 5, 3, 5, 3, 5};
  meter.push(errors);
  const ErrorScore score = libchar::score(meter, 1);
  CHECK(score.bias == 4);
  CHECK(score.deviation == Approx(1).epsilon(1e-14));
  CHECK(score.rmse == Approx(std::sqrt(17)).epsilon(1e-14));
}

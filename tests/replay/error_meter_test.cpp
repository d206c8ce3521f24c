#include "libchar/replay/error_meter.hpp"

#include <catch2/catch.hpp>
#include <cmath>

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

TEST_CASE("scores: bootstrap intervals cover the truth for correlated errors") {
  int covered = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const ErrorScore s = score(metered(errors(20000, 0.98, seed)), 1);
    covered += s.rmse_ci95.low <= 1 && 1 <= s.rmse_ci95.high;
  }
  // 40 blocks give a few per cent less than 95; independent samples would give about 20.
  CHECK(covered >= 172);
  CHECK(covered < 200);
}

TEST_CASE("scores: a difference is resolved when there is one") {
  const auto e = errors(20000, 0.9, 1), other = errors(20000, 0.9, 2);
  std::vector<double> worse = e;
  for (std::size_t i = 0; i < worse.size(); ++i) worse[i] = 1.02 * e[i] + 0.01 * other[i];
  // Paired: a 2 % difference between errors that go together shows, where each interval alone is
  // wider.
  const Interval paired = rmse_ratio_ci95(metered(worse), metered(e));
  CHECK(paired.low > 1.015);
  CHECK(paired.high < 1.025);
  const Interval apart = rmse_ratio_ci95(metered(errors(20000, 0.9, 3)), metered(e));
  CHECK(apart.low < 1);
  CHECK(apart.high > 1);
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

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/error.hpp"
#include "libchar/fit/curve/bounds.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/detail/curve/polish.hpp"
#include "libchar/fit/fit_json.hpp"
#include "libchar/fit/fit_options.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "libchar/fit/record/power_sums.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

/// Bins whose energy is exactly the expectation.
std::vector<PowerBin> noise_free(const Mixture& theta, double rate_hz) {
  test::NoiseSource source(30000, rate_hz, 1);
  std::vector<PowerBin> bins = power_bins(source.record(1, 0, 0), rate_hz);
  for (PowerBin& bin : bins) {
    bin.energy = 0;
    for (std::size_t i = 0; i < kTerms; ++i) bin.energy += theta[i] * bin.unit[i];
  }
  return bins;
}

}  // namespace

TEST_CASE("noise-free bins give their coefficients back to nine digits") {
  const Mixture theta = {1e-6, 1e-4, 25e-6, 0, 0};
  const NoiseFit fit = fit_power_bins(noise_free(theta, 200), 200, 30000, nullptr);
  for (std::size_t i = 0; i < 3; ++i) CHECK(fit.term[i].value.value() == Approx(std::sqrt(theta[i])).epsilon(1e-9));
  CHECK(fit.search.converged);
  CHECK(fit.remedies.empty());
}

TEST_CASE("a term that scoring left beside its bound is at its bound") {
  const BinProblem problem = bin_problem(noise_free({1e-6, 0, 25e-6, 0, 0}, 200));
  ModelPoint start;
  start.theta = {1e-6, 1e-30, 25e-6, 0, 0};
  const Polished found = polish(problem, start);
  CHECK(found.at.theta[1] == 0);
  CHECK(found.at.theta[2] == Approx(25e-6).epsilon(1e-9));
  CHECK(found.converged);
}

TEST_CASE("the deviance residual and its slope") {
  for (const double u : {1e-3, 0.5, 0.98999, 0.9901, 1 - 1e-9, 1.0, 1 + 1e-9, 1.0099, 1.0101, 3.0, 50.0}) {
    const long double d = static_cast<long double>(u) - 1;
    const auto r = deviance_residual(u, 1, 8);
    if (u != 1)
      CHECK(r.value * r.value ==
            Approx(static_cast<double>(8 * (d - std::log1p(d)))).epsilon(u > 0.9 && u < 1.1 ? 1e-7 : 1e-12));
    const double h = 1e-6;
    const double slope = (deviance_residual(u, 1 + h, 8).value - deviance_residual(u, 1 - h, 8).value) /
                         (std::log1p(h) - std::log1p(-h));
    CHECK(r.slope == Approx(slope).epsilon(1e-7));
  }
}

TEST_CASE("scaling a record scales the coefficients, an offset of 1e6 sigma changes nothing that matters") {
  test::NoiseSource source(50000, 200, 4);
  const std::vector<double> y = source.record(1e-3, 1e-2, 5e-3);
  std::vector<double> scaled = y, shifted = y;
  for (double& value : scaled) value *= 1024;
  for (double& value : shifted) value += 1e6;
  const NoiseFit fit = fit_record(y, 200, nullptr), big = fit_record(scaled, 200, nullptr),
                 off = fit_record(shifted, 200, nullptr);
  for (std::size_t i = 0; i < 3; ++i) {
    REQUIRE(fit.term[i].value);
    CHECK(big.term[i].value.value() == Approx(1024 * *fit.term[i].value).epsilon(1e-9));
    CHECK(off.term[i].value.value() == Approx(*fit.term[i].value).epsilon(1e-5));
  }
}

TEST_CASE("bins do not depend on how samples are pushed, blocks and gaps included") {
  test::NoiseSource source(5 * PowerPart::kBlock + 9000, 10, 8);
  std::vector<double> y = source.record(1, 0.3, 0.05);
  y[100] = y[4000] = std::numeric_limits<double>::quiet_NaN();
  PowerPart whole, pieces;
  whole.push(y);
  for (std::size_t from = 0, n = 1; from < y.size(); from += n, n = n * 3 % 701 + 1) {
    pieces.push(std::span<const double>(y).subspan(from, std::min(n, y.size() - from)));
  }
  const auto a = power_bins(powers_of(whole.finish(true)), 10), b = power_bins(powers_of(pieces.finish(true)), 10);
  REQUIRE(a.size() == b.size());
  for (std::size_t j = 0; j < a.size(); ++j) {
    CHECK(a[j].energy == b[j].energy);
    CHECK(a[j].dof == b[j].dof);
  }
}

TEST_CASE("a long gap starts a new segment") {
  std::vector<double> y(20000);
  test::Gaussian gauss(2);
  for (std::size_t t = 0; t < y.size(); ++t) y[t] = gauss() + (t > 8000 ? 1000 : 0);
  for (std::size_t t = 7000; t < 12000; ++t) y[t] = std::numeric_limits<double>::quiet_NaN();
  const NoiseFit fit = fit_record(y, 1, nullptr);
  CHECK(fit[Term::white].value.value() == Approx(1).epsilon(0.03));
  CHECK(fit[Term::walk].status == Status::not_detected);
  CHECK(fit.samples == 15000);
}

TEST_CASE("a first-order low-pass is found and its corner given") {
  test::NoiseSource source(100000, 100, 12);
  std::vector<double> x = source.record(1e-3, 0, 1e-2), y = x;
  const double a = std::exp(-2 * M_PI * 15 / 100);
  for (std::size_t t = 1; t < y.size(); ++t) y[t] = a * y[t - 1] + (1 - a) * x[t];
  const NoiseFit fit = fit_record(y, 100, nullptr);
  REQUIRE(fit.bandwidth_hz);
  CHECK(*fit.bandwidth_hz == Approx(15).epsilon(0.03));
  CHECK(fit[Term::white].value.value() == Approx(1e-3).epsilon(0.03));
  CHECK(fit.remedies.at(0).kind == "bandwidth");
}

TEST_CASE("quantization is added when the high frequencies ask for it") {
  test::Gaussian gauss(21);
  std::vector<double> y(100000);
  double before = gauss();
  for (double& value : y) {
    const double q = gauss();
    value = 0.01 * (q - before) * 100 + 0.5 * gauss();  // Qz = 0.01, Q = 0.05 at 100 Hz
    before = q;
  }
  const NoiseFit fit = fit_record(y, 100, nullptr);
  REQUIRE(fit[Term::quantization].value);
  CHECK(*fit[Term::quantization].value == Approx(0.01).epsilon(0.03));
  CHECK(fit[Term::white].value.value() == Approx(0.05).epsilon(0.03));
}

TEST_CASE("of short sound records the Allan fit is hardly ever rejected") {
  int rejected = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    test::NoiseSource source(600, 50, seed);
    const std::vector<double> y = source.record(0.14, 0.15, 0.03);
    const AllanCurve curve = allan_deviation(y, 1.0 / 50);
    const NoiseFit fit = fit_record(y, 50, &curve);
    rejected += fit.second_opinion && fit.second_opinion->goodness.p < 1e-4;
  }
  CHECK(rejected <= 1);  // 8 with the points of few degrees of freedom
}

TEST_CASE("the Allan fit agrees on clean noise and says when it does not") {
  test::NoiseSource source(200000, 200, 5);
  const std::vector<double> y = source.record(1e-3, 1e-2, 5e-3);
  const AllanCurve curve = allan_deviation(y, 1.0 / 200);
  const NoiseFit fit = fit_record(y, 200, &curve);
  REQUIRE(fit.second_opinion);
  CHECK(fit.second_opinion->agrees);
  CHECK(fit.second_opinion->sentence == "agrees");
  CHECK(*fit.second_opinion->value[0] == Approx(*fit[Term::white].value).epsilon(0.01));
  CHECK(fit.second_opinion->goodness.p > 1e-3);
  AllanCurve wrong = curve;
  for (std::size_t i = 0; i < 4; ++i) wrong.points[i].deviation *= 1.1;
  CHECK_FALSE(fit_record(y, 200, &wrong).second_opinion->agrees);
}

TEST_CASE("bounds: the table of the theory, and the length for 10 %") {
  const TermSet all = {true, true, true, false, false};
  const auto bound = cramer_rao({1e-6, 1e-4, 25e-6, 0, 0}, 200, 200000, all);
  CHECK(100 * *bound[0] == Approx(0.350).epsilon(0.01));
  CHECK(100 * *bound[1] == Approx(0.646).epsilon(0.01));
  CHECK(100 * *bound[2] == Approx(8.40).epsilon(0.01));
  const auto white = cramer_rao({25e-6, 0, 0, 0, 0}, 200, 200000, {true, false, false, false, false});
  CHECK(*white[0] == Approx(1 / std::sqrt(2 * 199999.0)).epsilon(1e-6));
  const NoiseFit fit = fit_power_bins(noise_free({1e-6, 1e-4, 25e-6, 0, 0}, 200), 200, 30000, nullptr);
  const double seconds = fit[Term::flicker].seconds_for_10_percent.value();
  CHECK(*cramer_rao(fit.theta, 200, seconds * 200, all)[1] == Approx(0.1).epsilon(0.01));
}

TEST_CASE("what cannot be fitted is refused in a sentence") {
  CHECK_THROWS_AS(fit_record(std::vector<double>(1000, 3.0), 10, nullptr), Error);
  CHECK_THROWS_AS(fit_record(std::vector<double>{1, 2}, 10, nullptr), Error);
  CHECK_THROWS_AS(fit_record(std::vector<double>{}, 10, nullptr), Error);
  FitOptions none;
  none.terms = {};
  CHECK_THROWS_AS(fit_record(test::NoiseSource(100, 1, 1).record(1, 0, 0), 1, nullptr, none), Error);
}

TEST_CASE("an absent term has no value, only a limit, in the JSON too") {
  test::NoiseSource source(20000, 100, 31);
  const NoiseFit fit = fit_record(source.record(1e-2, 0, 0), 100, nullptr);
  const Json json = noise_fit_json("gx", "deg/s", fit);
  for (const char* key : {"bias_instability", "random_walk"}) {
    CHECK(json[key]["value"].is_null());
    CHECK(json[key]["status"] == "not_detected");
    CHECK(json[key]["upper95"].get<double>() > 0);
  }
  CHECK(json["white_noise"]["value"].get<double>() == Approx(1e-2).epsilon(0.03));
  CHECK(json["white_noise"]["ci95"].size() == 2);
  CHECK(json["quantization"]["status"] == "not_fitted");
}

TEST_CASE("a fit converges whose scoring creeps towards a bound") {
  test::NoiseSource source(200, 1, 32);
  std::vector<double> record;
  for (int r = 0; r <= 1272; ++r) record = source.record(1, 1, 0);  // one in 12,000
  CHECK(fit_record(record, 1, nullptr).search.converged);
}

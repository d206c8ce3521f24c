// Intervals of terms that are reported because they passed a threshold.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "libchar/core/numeric/distributions.hpp"
#include "libchar/fit/detail/curve/profile.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "libchar/fit/record/power_bins.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

double density(double x) { return std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi); }

/// Of z ~ N(mean, 1) reported when z > c, the share whose lower limit is below the mean.
double share_below(double mean, double c) {
  constexpr double kStep = 1e-3;
  double below = 0, all = 0;
  for (double z = c + kStep / 2; z < mean + c + 12; z += kStep) {
    const double weight = density(z - mean);
    all += weight;
    if (z - mean <= std::sqrt(selected_rise(z * z, c * c))) below += weight;
  }
  return below / all;
}

}  // namespace

TEST_CASE("selected lower limits: 97.5 % of what is reported, whatever the truth") {
  for (const double mean : {0.0, 0.5, 1.0, 2.0, 2.326, 3.0, 5.0})
    for (const double c : {std::sqrt(5.41), 4.0}) {
      INFO("mean " << mean << " threshold " << c);
      CHECK(std::abs(share_below(mean, c) - 0.975) < 1e-3);
    }
}

TEST_CASE("selected lower limits: zero at the threshold, the plain limit far from it") {
  CHECK(selected_rise(5.5, 5.41) > 5.5);
  CHECK(selected_rise(12.0, 5.41) > 12.0);
  CHECK(selected_rise(13.0, 5.41) < 13.0);
  CHECK(selected_rise(60, 5.41) == Approx(kTwoSided95).epsilon(1e-3));
  CHECK(selected_rise(INFINITY, 5.41) == kTwoSided95);
}

TEST_CASE("upper limits: exact for the mean of few squares, that of chi-square for many") {
  for (const double dof : {1.0, 2.0, 7.0, 60.0})
    for (const double tail : {0.025, 0.05}) {
      BinProblem problem;
      problem.energy = Eigen::ArrayXd::Constant(3, 1.7);
      problem.dof = Eigen::ArrayXd::Constant(3, dof / 3);
      problem.unit.setZero(3, kTerms);
      problem.unit.col(0).setConstant(4);
      const TermSet white = {true, false, false, false, false};
      const ScoringResult best = score(problem, white);
      const double upper = profile_upper(problem, white, {best.at, best.half_deviance}, 0, 1.7 / 4, tail);
      INFO(dof << " squares, tail " << tail);
      CHECK(upper == Approx(1.7 / 4 * dof / chi_square_quantile(tail, dof)).epsilon(1e-3));
    }
  CHECK(rise_below(0.025, 0) == Approx(kTwoSided95));
  CHECK(rise_below(0.025, 0.011) == Approx(kTwoSided95).epsilon(0.01));
  CHECK(rise_below(0.05, 2) == Approx(4.04).epsilon(0.001));  // two squares
}

TEST_CASE("a few rounded samples, some coefficients of which are none, are no shape of the spectrum") {
  const std::vector<double> y = {0, -2e-3, 0, 2e-3, 0, 0, 0, 0, 0, 0};
  const NoiseFit fit = fit_record(y, 100, nullptr, {});
  for (const Coefficient& term : fit.term) CHECK((!term.value || *term.value > 1e-6));
}

TEST_CASE("a drift through a short record is no low-pass with a corner below it") {
  test::Gaussian normal(1);
  for (const int n : {64, 100, 200, 400, 800}) {
    CAPTURE(n);
    std::vector<double> y;
    for (int i = 0; i < n; ++i) y.push_back(i + normal());
    const NoiseFit fit = fit_record(y, 100, nullptr, {});
    const Coefficient& white = fit[Term::white];
    CHECK((!white.value || white.status == Status::misfit || *white.value == Approx(0.1).epsilon(0.5)));
    CHECK((white.value || (white.upper95 && *white.upper95 > 0.08)));
  }
}

TEST_CASE("upper limits of short records hold the truth, and white noise that flicker explains is not detected") {
  constexpr std::size_t n = 200;
  constexpr double kRate = 100, kFlicker = 1, kRounding = 0.05;
  constexpr int kRecords = 200;
  test::NoiseSource source(n, kRate, 5);
  test::Gaussian normal(6);
  FitOptions options;
  options.terms = {true, true, true, true, false};
  int false_limits = 0, false_white = 0;
  for (int r = 0; r < kRecords; ++r) {
    std::vector<double> y = source.record(0, kFlicker, 0);
    double before = normal();
    for (double& value : y) {
      const double now = normal();
      value += kRounding * kRate * (now - before);
      before = now;
    }
    const NoiseFit fit = fit_record(y, kRate, nullptr, options);
    const Coefficient &n_of = fit[Term::white], &b = fit[Term::flicker];
    false_limits += b.status == Status::not_detected && *b.upper95 < kFlicker ? 1 : 0;
    false_white += n_of.status == Status::detected ? 1 : 0;
  }
  CHECK(false_limits <= 0.06 * kRecords);
  CHECK(false_white <= 0.06 * kRecords);
}

TEST_CASE("the value in the model of all terms is right on average where a neighbour is not detected") {
  constexpr std::size_t n = 16384;
  constexpr double kFlicker = 0.15, kWalk = 0.003;
  test::NoiseSource source(n, 1, 77);
  FitOptions options;
  options.second_opinion = options.remedies = false;
  double reported = 0, in_all = 0, variance = 0;
  int records = 0, other_model = 0;
  for (int r = 0; r < 300; ++r) {
    const std::vector<double> y = source.record(1, kFlicker, kWalk);
    const NoiseFit fit = fit_power_bins(power_bins(y, 1), 1, n, nullptr, options);
    const Coefficient& b = fit[Term::flicker];
    if (!b.value) continue;
    REQUIRE(b.in_all);
    const double square = b.in_all->square, sd = b.in_all->sd;
    ++records;
    other_model += std::abs(square / (*b.value * *b.value) - 1) > 1e-6;
    reported += std::pow(*b.value / kFlicker, 2);
    in_all += square / (kFlicker * kFlicker);
    variance += std::pow(sd / (kFlicker * kFlicker), 2);
  }
  CHECK(records > 295);
  CHECK(other_model > 150);  // K is mostly not detected
  const double error = std::sqrt(variance) / records;
  CHECK(std::abs(in_all / records - 1) < 3.5 * error);
  CHECK(reported / records - 1 > 3.5 * error);
}

TEST_CASE("where all terms are reported the model of all terms is that of the report") {
  constexpr std::size_t n = 1 << 15;
  test::NoiseSource source(n, 1, 5);
  const std::vector<double> y = source.record(1, 0.4, 0.05);
  FitOptions options;
  options.second_opinion = false;
  options.white_top = true;
  const NoiseFit fit = fit_power_bins(power_bins(y, 1), 1, n, nullptr, options);
  for (const Term term : {Term::white, Term::flicker, Term::walk}) {
    CHECK(fit[term].status == Status::detected);
    REQUIRE(fit[term].in_all);
    CHECK(fit[term].in_all->square == Approx(*fit[term].value * *fit[term].value).epsilon(1e-6));
    CHECK(fit[term].in_all->sd == Approx(2 * fit[term].relative_sd * fit[term].in_all->square).epsilon(0.03));
  }
}

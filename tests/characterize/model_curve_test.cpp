#include "libchar/characterize/curves/model_curve.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "libchar/allan/noise_curves.hpp"
#include "libchar/fit/signs/stationarity.hpp"
#include "libchar/spectrum/spectrum_words.hpp"
#include "tests/report/synthetic.hpp"

using namespace libchar;

namespace {

NoiseFit white_behind_low_pass(double bandwidth_hz) {
  NoiseFit fit;
  fit.theta[0] = 1;
  fit.bandwidth_hz = bandwidth_hz;
  return fit;
}

}  // namespace

TEST_CASE("Allan curve of white noise behind a low-pass: the ratios of half the Haar variance of the sampled AR(1)") {
  struct Row {
    double bandwidth_over_rate;
    double ratio[6];
  };
  const Row rows[] = {{0.4, {.781, .879, .939, .969, .985, .996}},
                      {0.25, {.520, .693, .838, .919, .959, .990}},
                      {0.1, {.142, .276, .500, .723, .860, .965}}};
  const double factors[] = {1, 2, 4, 8, 16, 64}, dt_s = 0.005;
  for (const Row& row : rows) {
    const NoiseFit fit = white_behind_low_pass(row.bandwidth_over_rate / dt_s);
    for (int i = 0; i < 6; ++i) {
      const double deviation = *model_deviation(fit, DeviationType::oadev, factors[i], dt_s);
      CHECK(deviation * deviation * factors[i] * dt_s == Approx(row.ratio[i]).margin(6e-4));
    }
  }
}

TEST_CASE("the low-pass in the spectrum and in the Allan curve are the same filter") {
  // AVAR(1) = integral of S(f) 2 sin^4(pi f dt)/sin^2(pi f dt) over one period of the sampled density
  const double dt_s = 0.01, bandwidth_hz = 13;
  double sum = 0;
  const int steps = 20000;
  for (int i = 0; i < steps; ++i) {
    const double f = (i + 0.5) / steps / (2 * dt_s), s = std::sin(std::numbers::pi * f * dt_s);
    const double r = std::exp(-2 * std::numbers::pi * bandwidth_hz * dt_s);
    const double gain = (1 - r) * (1 - r) / (1 - 2 * r * std::cos(2 * std::numbers::pi * f * dt_s) + r * r);
    sum += gain * 2 * s * s;
  }
  const double variance = 2 * sum / steps / (2 * dt_s);
  const double deviation = *model_deviation(white_behind_low_pass(bandwidth_hz), DeviationType::oadev, 1, dt_s);
  CHECK(deviation * deviation == Approx(variance).epsilon(1e-4));
}

TEST_CASE("read-off points: Q at 1 s, 0.664 B, K at 3 s, only for what is there") {
  const auto channel = test::synthetic_channel("x", "deg/s", {}, 1);
  const auto points = read_off_points(*channel.fit, channel.allan);
  REQUIRE(points.size() == 3);
  CHECK(points[0].tau_s == 1);
  CHECK(points[0].deviation == Approx(*channel.fit->term[0].value));
  CHECK(points[1].deviation == Approx(0.6642824703 * *channel.fit->term[1].value));
  CHECK(points[2].tau_s == 3);
  CHECK(points[2].deviation == Approx(*channel.fit->term[2].value));
  test::Truth calm;
  calm.k = 0;
  const auto without = test::synthetic_channel("x", "deg/s", calm, 1);
  CHECK(read_off_points(*without.fit, without.allan).size() == 2);
}

TEST_CASE("densities: one-sided is twice two-sided, roots are roots, powers carry the noise bandwidth") {
  Spectrum s;
  s.enbw_hz = 0.25;
  CHECK(scaled_density(s, 3.0) == 6.0);
  s.sides = Sides::two;
  CHECK(scaled_density(s, 3.0) == 3.0);
  s.scaling = Scaling::ps;
  CHECK(scaled_density(s, 3.0) == 0.75);
  s.scaling = Scaling::ls;
  CHECK(scaled_density(s, 3.0) == Approx(std::sqrt(0.75)));
  s.scaling = Scaling::lsd;
  CHECK(scaled_density(s, 4.0) == 2.0);
}

TEST_CASE("units of spectra") {
  CHECK(spectrum_unit(Scaling::psd, "deg/s") == "(deg/s)²/Hz");
  CHECK(spectrum_unit(Scaling::psd, "V") == "V²/Hz");
  CHECK(spectrum_unit(Scaling::lsd, "m/s²") == "(m/s²)/√Hz");
  CHECK(spectrum_unit(Scaling::ps, "") == "U²");
  CHECK(spectrum_unit(Scaling::ls, "g") == "g");
}

TEST_CASE("nothing below zero or at zero frequency is predicted") {
  const auto channel = test::synthetic_channel("x", "deg/s", {}, 1);
  CHECK(!model_spectrum(*channel.fit, channel.spectrum, 0));
  CHECK(!model_deviation(*channel.fit, DeviationType::mdev, 4, 0.005));
  CHECK(!model_deviation(NoiseFit{}, DeviationType::oadev, 4, 0.005));
}

TEST_CASE("model interval: of one term it is the term's, and limits of terms not seen widen it") {
  NoiseFit fit;
  fit.rate_hz = 10;
  fit.theta[0] = 0.04;
  Coefficient& white = fit.term[0];
  white.status = Status::detected;
  white.value = 0.2;
  white.ci95 = {0.19, 0.22};
  const double deviation = *model_deviation(fit, DeviationType::oadev, 100, 0.1);
  Interval stated = *model_interval(fit, DeviationType::oadev, 100, 0.1);
  CHECK(stated.low == Approx(deviation * 0.95));
  CHECK(stated.high == Approx(deviation * 1.1));
  Coefficient& walk = fit.term[2];
  walk.status = Status::not_detected;
  walk.upper95 = 0.02;
  stated = *model_interval(fit, DeviationType::oadev, 100, 0.1);
  CHECK(stated.low == Approx(deviation * 0.95));
  Mixture one{};
  one[2] = 1;
  const double up = 0.0004 * allan_variance(one, 100, 0.1), white_up = deviation * deviation * (1.1 * 1.1 - 1);
  CHECK(stated.high == Approx(std::sqrt(deviation * deviation + std::hypot(up, white_up))));
  fit.stationarity.tested = true;
  fit.stationarity.steady = false;
  fit.stationarity.spread = {{1, 16, 0.1, 0}};
  const Interval wider = *model_interval(fit, DeviationType::oadev, 100, 0.1);
  CHECK(std::log(deviation / wider.low) == Approx(std::hypot(std::log(1 / 0.95), spread_reach(fit.stationarity, 10))));
  CHECK(!model_interval(fit, DeviationType::mdev, 100, 0.1));
}

// An even motion is told from the noise of a sensor that rests: by its own noise below the motion, or by N itself.
#include "libchar/characterize/detail/rest_doubt.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/fit/noise_fit.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using detail::doubt_rest;

namespace {

constexpr double kRestRate = 100, kOwnNoise = 1e-3;

std::vector<double> rest_white(std::size_t n, std::uint64_t seed, double sd) {
  test::Gaussian draw(seed);
  std::vector<double> y(n);
  for (double& v : y) v = sd * draw();
  return y;
}

/// Two poles at about `hz`, of this standard deviation.
std::vector<double> slow_motion(std::size_t n, double hz, double sd) {
  const std::vector<double> u = rest_white(n, 77, 1);
  const double pole = std::exp(-2 * std::acos(-1.0) * hz / kRestRate);
  std::vector<double> y(n);
  double first = 0, second = 0, squares = 0;
  for (std::size_t t = 0; t < n; ++t) {
    first = pole * first + u[t];
    second = pole * second + first;
    y[t] = second;
    squares += second * second;
  }
  for (double& v : y) v *= sd / std::sqrt(squares / static_cast<double>(n));
  return y;
}

NoiseFit fit_of_motion(double sd, double hz, double own = kOwnNoise) {
  std::vector<double> y = slow_motion(40000, hz, sd);
  const std::vector<double> noise = rest_white(y.size(), 5, own);
  for (std::size_t t = 0; t < y.size(); ++t) y[t] += noise[t];
  return fit_record(y, kRestRate, nullptr);
}

}  // namespace

TEST_CASE("an even motion above the noise of an inertial sensor is no rest") {
  for (const double hz : {0.3, 3.0}) {
    CAPTURE(hz);
    const auto moves = doubt_rest(fit_of_motion(0.1, hz), "rad/s", 0);
    REQUIRE(moves);
    CHECK(moves->code == "moves_throughout");
    CHECK(moves->severity == Severity::bad);
    CHECK(doubt_rest(fit_of_motion(0.1, hz), "degC", 0) == std::nullopt);
  }
  const auto perhaps = doubt_rest(fit_of_motion(0.004, 3), "rad/s", 0);
  REQUIRE(perhaps);
  CHECK(perhaps->severity == Severity::caution);
}

TEST_CASE("what rocks shows a peak, and a sensor behind a high-pass and a low-pass has none") {
  const std::vector<double> u = rest_white(90000, 7, 1);
  const auto two_poles = [&](double low, double high, double sd) {  // each of first order, and twice
    std::vector<double> y = u;
    for (const bool above : {true, true, false, false}) {
      const double pole = std::exp(-2 * std::acos(-1.0) * (above ? low : high) / kRestRate);
      double state = 0;
      for (double& v : y) {
        state = pole * state + (1 - pole) * v;
        v = above ? v - state : state;
      }
    }
    double squares = 0;
    for (const double v : y) squares += v * v;
    for (double& v : y) v *= sd / std::sqrt(squares / static_cast<double>(y.size()));
    return fit_record(y, kRestRate, nullptr);
  };
  const auto rocks = doubt_rest(two_poles(0.6, 0.8, 0.05), "rad/s", 0);
  REQUIRE(rocks);
  CHECK(rocks->code == "moves_throughout");
  CHECK(rocks->severity == Severity::bad);
  CHECK(doubt_rest(two_poles(0.6, 0.8, 0.05), "degC", 0) == std::nullopt);
  CHECK(doubt_rest(two_poles(0.1, 20, 0.05), "m/s^2", 0) == std::nullopt);
  CHECK(doubt_rest(two_poles(1, 15, 0.05), "m/s^2", 0) == std::nullopt);
}

TEST_CASE("noise of a sensor at rest, behind a low-pass too, is rest") {
  CHECK(doubt_rest(fit_of_motion(0, 3), "rad/s", 0) == std::nullopt);
  CHECK(doubt_rest(fit_of_motion(0.1, 3, 0), "deg/s", 0) == std::nullopt);
  // The level that is left is that of the converter.
  CHECK(doubt_rest(fit_of_motion(0.1, 3), "deg/s", kOwnNoise * kOwnNoise / kRestRate) == std::nullopt);
}

TEST_CASE("white noise beyond that of any gyroscope or accelerometer is no rest") {
  const NoiseFit fit = fit_record(rest_white(20000, 6, 0.1), kRestRate, nullptr);  // N 0.01
  CHECK(doubt_rest(fit, "rad/s", 0));
  CHECK(doubt_rest(fit, "deg/s", 0) == std::nullopt);
  CHECK(doubt_rest(fit, "m/s^2", 0) == std::nullopt);
  CHECK(doubt_rest(fit, "g", 0) == std::nullopt);
  CHECK(doubt_rest(fit_record(rest_white(20000, 6, 2), kRestRate, nullptr), "m/s^2", 0));
}

TEST_CASE(
    "a record louder than any sensor at rest is fitted with the terms alone, as one that is not to be explained") {
  const auto fit_with = [](double most, bool explain) {
    std::vector<double> y = slow_motion(40000, 3, 0.1);
    const std::vector<double> noise = rest_white(y.size(), 5, kOwnNoise);
    for (std::size_t t = 0; t < y.size(); ++t) y[t] += noise[t];
    FitOptions options;
    options.explain = explain;
    if (most > 0) options.at_rest = detail::AtRest{most, 0.05};
    return fit_record(y, kRestRate, nullptr, options);
  };
  const NoiseFit whole = fit_with(0, true), alone = fit_with(0, false), loud = fit_with(1e-6, true);
  CHECK_FALSE((whole.band.whole && whole.shape.kind == NoiseShape::Kind::none));
  CHECK((alone.band.whole && alone.shape.kind == NoiseShape::Kind::none));
  CHECK(loud.theta == alone.theta);
  CHECK(fit_with(1, true).theta == whole.theta);
  CHECK(doubt_rest(alone, "rad/s", 0)->severity == Severity::bad);
}

TEST_CASE("how far a density is above the loudest sensor counts its degrees of freedom") {
  const detail::AtRest limit{4, 0.05};
  CHECK(limit.excess(1, 4, 1e9) == Approx(1).epsilon(1e-3));
  CHECK(limit.excess(1, 8, 10) < 1);  // by chance
  CHECK(limit.excess(1, 40, 10) > 1);
  CHECK(limit.excess(1, 40, 7) == 0);
  CHECK(limit.excess(0.04, 1e9, 1e3) == 0);
  CHECK(detail::limit_at_rest("deg/s")->most_density == Approx(0.125));
  CHECK_FALSE(detail::limit_at_rest("degC"));
}

TEST_CASE("slow noise beyond that of any gyroscope or accelerometer is no rest") {
  std::vector<double> walk(30000);
  const std::vector<double> steps = rest_white(walk.size(), 8, 0.04);  // K 0.4 per root second
  for (std::size_t t = 1; t < walk.size(); ++t) walk[t] = walk[t - 1] + steps[t];
  const NoiseFit fit = fit_record(walk, kRestRate, nullptr);
  const auto moves = doubt_rest(fit, "m/s^2", 0);
  REQUIRE(moves);
  CHECK(moves->severity == Severity::bad);
  CHECK(doubt_rest(fit, "mg", 0) == std::nullopt);
  CHECK(doubt_rest(fit, "degC", 0) == std::nullopt);
}

TEST_CASE("what is fixed to a body that turns throughout does not rest") {
  const auto log_of = [](std::vector<const char*> turning) {
    std::vector<ChannelResult> out;
    for (const char* name : {"gx", "gy", "gz", "ax", "temp"}) {
      out.emplace_back();
      out.back().channel = {name, *name == 'g' ? "deg/s" : *name == 'a' ? "m/s^2" : "degC"};
      out.back().motion.whole =
          std::any_of(turning.begin(), turning.end(), [&](std::string_view one) { return one == name; });
    }
    detail::doubt_together(out);
    return out;
  };
  const auto moved = log_of({"gx", "gy"});
  CHECK(has(moved[2].findings, "moves_with_others"));
  CHECK(has(moved[3].findings, "moves_with_others"));
  for (const Finding::Help& help : moved[3].findings.back().help) CHECK(help.options.empty());  // no way around
  for (const std::size_t c : {0, 1, 4}) CHECK_FALSE(has(moved[c].findings, "moves_with_others"));
  // A table that turns about one axis; what vibrates without turning.
  for (const auto& turning : {std::vector{"gz"}, {"ax"}, {}})
    for (const ChannelResult& one : log_of(turning)) CHECK(one.findings.empty());
}

TEST_CASE("what is fixed to gyroscopes that turn cannot be at rest: how many turn is said") {
  const auto channels_of = [](std::size_t turning, std::size_t resting) {
    std::vector<ChannelResult> out(turning + resting + 2);
    for (std::size_t c = 0; c < turning + resting; ++c) {
      out[c].channel.name = "g" + std::to_string(c);
      out[c].channel.unit = "rad/s";
      out[c].motion.whole = c < turning;
    }
    out[turning + resting].channel.unit = "m/s^2";
    out[turning + resting + 1].channel.unit = "degC";
    detail::doubt_together(out);
    return out;
  };
  const auto said = [](const ChannelResult& one) {
    return one.findings.empty() ? "" : one.findings[0].sentence.substr(0, one.findings[0].sentence.find(" through"));
  };
  CHECK(said(channels_of(1, 1)[2]) == "g0 turns");
  CHECK(said(channels_of(1, 1)[1]) == "g0 turns");
  CHECK(said(channels_of(2, 0)[2]) == "g0 and 1 other gyroscope turn");
  CHECK(said(channels_of(3, 1)[4]) == "g0 and 2 other gyroscopes turn");
  CHECK(said(channels_of(3, 1)[0]).empty());  // what turns itself says so elsewhere
  CHECK(said(channels_of(3, 1)[5]).empty());  // a thermometer may turn
  CHECK(said(channels_of(1, 2)[3]).empty());  // fewer than half
  CHECK(said(channels_of(0, 2)[2]).empty());
}

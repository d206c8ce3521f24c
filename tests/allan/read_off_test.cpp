#include "libchar/allan/read_off.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/allan/noise_curves.hpp"

using namespace libchar;

namespace {

AllanCurve curve_of(const Mixture& theta) {
  AllanCurve curve;
  curve.dt_s = 0.01;
  for (std::uint64_t m = 1; m <= (1ULL << 24U); m *= 2) {
    AllanPoint p;
    p.m = m;
    p.tau_s = 0.01 * double(m);
    p.deviation = std::sqrt(allan_variance(theta, double(m), 0.01));
    curve.points.push_back(p);
  }
  return curve;
}

}  // namespace

TEST_CASE("read-off marks of a curve with all three regimes well apart") {
  const double q = 1e-2, b = 1e-4, k = 1e-6;
  const ReadOff marks = read_off(curve_of({q * q, b * b, k * k, 0, 0}));
  REQUIRE(marks.white_noise);
  CHECK(*marks.white_noise == Approx(q).epsilon(0.01));
  REQUIRE(marks.random_walk);
  CHECK(*marks.random_walk >= k);
  CHECK(*marks.random_walk ==
        Approx(k).epsilon(0.1));  // the record ends where flicker still adds to the line
  CHECK(marks.minimum >= 0.664 * b);
  CHECK(marks.bias_instability_upper == Approx(marks.minimum / 0.6642824703).epsilon(1e-9));
  CHECK(marks.bias_instability_upper < 2 * b);
}

TEST_CASE("no mark where the curve does not follow the line, none from unreliable points") {
  const ReadOff white = read_off(curve_of({1, 0, 0, 0, 0}));
  REQUIRE(white.white_noise);
  CHECK(*white.white_noise == Approx(1).epsilon(1e-12));
  CHECK_FALSE(white.random_walk);
  CHECK_FALSE(read_off(curve_of({0, 1, 0, 0, 0})).white_noise);
  CHECK_FALSE(read_off(AllanCurve{}).white_noise);
  AllanCurve curve = curve_of({1, 0, 0, 0, 0});
  curve.points.back().deviation = 1e-12;
  curve.points.back().reliable = false;
  CHECK(read_off(curve).minimum > 1e-6);
}

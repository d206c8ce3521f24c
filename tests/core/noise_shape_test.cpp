#include "libchar/core/numeric/noise_shape.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace libchar;

TEST_CASE("shapes: gains of moving averages, of the nearest measured point, and one at rest") {
  NoiseShape shape;
  CHECK(shape_ratio(shape, 17, 100) == 1);
  shape.kind = NoiseShape::Kind::boxcar;
  shape.taps = 2;
  CHECK(shape_ratio(shape, 25, 100) == Approx(0.5));              // cos²(pi/4)
  CHECK(shape_ratio(shape, 50, 100) == Approx(0).margin(1e-30));  // its zero
  CHECK(shape_ratio(shape, 1e-6, 100) == Approx(1));
  shape.kind = NoiseShape::Kind::bartlett;
  CHECK(shape_ratio(shape, 25, 100) == Approx(0.25));

  shape = {NoiseShape::Kind::measured, 0, {10, 20}, {0.5, 3}};
  CHECK(shape_ratio(shape, 9.5, 100) == 1);
  CHECK(shape_ratio(shape, 9.6, 100) == 0.5);
  CHECK(shape_ratio(shape, 14.1, 100) == 0.5);  // sqrt(10·20) = 14.14
  CHECK(shape_ratio(shape, 14.2, 100) == 3);
  CHECK(shape_ratio(shape, 50, 100) == 3);
}

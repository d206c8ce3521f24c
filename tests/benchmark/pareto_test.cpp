// Who is on a front, and how far the others are from it.

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/benchmark/detail/estimators.hpp"

using namespace libchar;

TEST_CASE("front: nobody is at least as cheap and better, by hand") {
  const auto gaps = front_gaps({{1, 10}, {2, 5}, {3, 6}, {4, 5}, {2, 5}, {NAN, 1}, {0.5, NAN}});
  CHECK(gaps[0] == 0);
  CHECK(gaps[1] == 0);
  CHECK(gaps[2] == Approx(0.2));  // 5 is to be had for less
  CHECK(gaps[3] == 0);            // dearer for the same error: no error to gain
  CHECK(gaps[4] == 0);            // equal in both
  CHECK(std::isnan(gaps[5]));
  CHECK(std::isnan(gaps[6]));
}

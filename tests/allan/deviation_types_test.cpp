#include "libchar/allan/deviation_types.hpp"

#include <catch2/catch.hpp>

using namespace libchar;

TEST_CASE("time errors are in the unit of the integral, seconds of fractional frequencies") {
  for (const DeviationType type :
       {DeviationType::tdev, DeviationType::ttotdev, DeviationType::mtie, DeviationType::tierms}) {
    CHECK(deviation_unit(type, "1") == "s");
    CHECK(deviation_unit(type, "") == "s");
    CHECK(deviation_unit(type, "deg/s") == "deg");
    CHECK(deviation_unit(type, "deg/s/s") == "deg/s");
    CHECK(deviation_unit(type, "g") == "g·s");
  }
  CHECK(deviation_unit(DeviationType::oadev, "deg/s") == "deg/s");
  CHECK(deviation_unit(DeviationType::mdev, "") == "");
}

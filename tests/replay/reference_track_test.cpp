// A reference between its own samples; an angle goes the short way round.
#include "libchar/replay/detail/align/reference_track.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace libchar;

TEST_CASE("linear between samples, missing beyond them", "[reference_track]") {
  ReferenceTrack track;
  track.start_s = 10;
  track.rate_hz = 2;
  track.values = {{1, 3, kMissing, 5}};
  CHECK(track.at(0, 10) == 1);
  CHECK(track.at(0, 10.125) == Approx(1.5));
  CHECK(track.at(0, 10.5) == 3);
  CHECK(std::isnan(track.at(0, 10.6)));
  CHECK(std::isnan(track.at(0, 9.9)));
  CHECK(track.at(0, 11.5) == 5);
  CHECK(std::isnan(track.at(0, 11.6)));
}

TEST_CASE("an angle goes the short way round", "[reference_track]") {
  ReferenceTrack track;
  track.rate_hz = 1;
  track.values = {{178, -178, 90, -90.5}};
  CHECK(track.at(0, 0.5) == Approx(0).margin(1e-12));  // no angle: a plain mean
  track.period = 360;
  CHECK(std::abs(track.at(0, 0.5)) == Approx(180));
  CHECK(track.at(0, 0.25) == Approx(179));
  CHECK(std::remainder(track.at(0, 0.75) + 179, 360) == Approx(0).margin(1e-12));
  CHECK(std::remainder(track.at(0, 1.5) - 136, 360) == Approx(0).margin(1e-12));
  CHECK(std::remainder(track.at(0, 2.5) - 179.75, 360) == Approx(0).margin(1e-12));
  CHECK(track.at(0, 1) == -178);
}

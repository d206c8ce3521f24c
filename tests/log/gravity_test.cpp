// An accelerometer at rest reads gravity: units and scales that it contradicts are named, with the factor that mends.

#include "libchar/log/gravity.hpp"

#include <catch2/catch.hpp>

using namespace libchar;

namespace {

struct Scene {
  std::vector<Channel> channels;
  std::vector<ChannelQuality> quality;
};

/// Three axes of this mean in this unit, with this scatter.
Scene triad(double z, const std::string& unit, double sd) {
  Scene out;
  for (const char* name : {"acc_x", "acc_y", "acc_z"}) {
    out.channels.push_back({name, unit, false});
    ChannelQuality q;
    q.samples = 1000;
    q.standard_deviation = sd;
    q.mean = name[4] == 'z' ? z : 0.01 * z;
    out.quality.push_back(q);
  }
  judge_gravity(out.channels, [&](std::size_t c) -> ChannelQuality& { return out.quality[c]; });
  return out;
}

std::string scale(const Scene& scene) {
  if (scene.quality[0].findings.empty()) return "none";
  const Finding& one = scene.quality[0].findings[0];
  CHECK(one.code == "not_gravity");
  CHECK(scene.quality[2].findings == scene.quality[0].findings);
  return one.help.empty() ? "" : one.help[0].options[0].value;
}

}  // namespace

TEST_CASE("gravity: a sound triad has no finding, in any unit and upside down") {
  CHECK(scale(triad(9.81, "m/s^2", 0.02)) == "none");
  CHECK(scale(triad(-9.6, "m/s^2", 0.02)) == "none");
  CHECK(scale(triad(1.03, "g", 0.002)) == "none");
  CHECK(scale(triad(-985, "mg", 2)) == "none");
}

TEST_CASE("gravity: g under the name of m/s², half the scale, and the other way round") {
  CHECK(scale(triad(1.0, "m/s^2", 0.001)) == "acc_x=9.80665");
  CHECK(scale(triad(9.79, "g", 0.01)) == "acc_x=1/9.80665");
  CHECK(scale(triad(0.5, "g", 0.001)) == "acc_x=2");
  CHECK(scale(triad(0.7, "g", 0.001)).empty());
  CHECK(scale(triad(981, "m/s^2", 2)) == "acc_x=1/100");
  CHECK(scale(triad(1000, "g", 2)) == "acc_x=1/1000");
  CHECK(scale(triad(1.0, "mg", 0.002)) == "acc_x=1000");
  CHECK(scale(triad(16384, "m/s^2", 30)).empty());  // counts
}

TEST_CASE("gravity: what was taken out is a caution, what moves is not judged") {
  CHECK(scale(triad(0.01, "m/s^2", 0.02)).empty());  // an offset as large as a mg, and its noise
  const Scene removed = triad(0, "m/s^2", 0.01);
  REQUIRE(removed.quality[1].findings.size() == 1);
  CHECK(removed.quality[1].findings[0].severity == Severity::caution);
  CHECK(scale(triad(5, "m/s^2", 2)) == "none");
}

TEST_CASE("gravity: one axis, other quantities and names without axes are not judged") {
  Scene one = triad(1, "m/s^2", 0.001);
  for (ChannelQuality& q : one.quality) q.findings.clear();
  one.channels[1].name = "temperature";
  judge_gravity(one.channels, [&](std::size_t c) -> ChannelQuality& { return one.quality[c]; });
  CHECK(one.quality[0].findings.empty());
  CHECK(scale(triad(1, "rad/s", 0.001)) == "none");
}

TEST_CASE("gravity: the columns of an array are axes") {
  Scene array = triad(1, "m/s^2", 0.001);
  for (std::size_t c = 0; c < 3; ++c) {
    array.quality[c].findings.clear();
    array.channels[c].name = "acc_" + std::string(1, static_cast<char>('0' + c));
  }
  judge_gravity(array.channels, [&](std::size_t c) -> ChannelQuality& { return array.quality[c]; });
  CHECK(array.quality[0].findings.size() == 1);
}

// An accelerometer at rest reads gravity: units and scales that it contradicts are named, with the factor that mends.
// Channels that repeat one another are named.

#include "libchar/log/between_channels.hpp"

#include <catch2/catch.hpp>

#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

struct Scene {
  std::vector<Channel> channels;
  std::vector<ChannelQuality> quality;
};

/// Three axes of this mean in this unit, with this scatter.
Scene triad(double z, const std::string& unit, double sd, const std::string& front = "acc_") {
  Scene out;
  for (const char axis : {'x', 'y', 'z'}) {
    out.channels.push_back({front + axis, unit, false});
    ChannelQuality q;
    q.samples = 1000;
    q.standard_deviation = sd;
    q.mean = axis == 'z' ? z : 0.01 * z;
    out.quality.push_back(q);
  }
  judge_together(out.channels, [&](std::size_t c) -> ChannelQuality& { return out.quality[c]; });
  return out;
}

std::string scale(const Scene& scene) {
  if (scene.quality[0].findings.empty()) return "none";
  const Finding& one = scene.quality[0].findings[0];
  CHECK(one.code == (scene.channels[0].name[0] == 'm' ? "not_earth_field" : "not_gravity"));
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

TEST_CASE("gravity: one axis and two tell where they read more than gravity, or upright 1 of another unit") {
  const auto axis = [](const std::string& name, double mean, const std::string& unit) {
    const std::vector<Channel> channels = {{name, unit, false}};
    std::vector<ChannelQuality> quality(1);
    quality[0].samples = 1000;
    quality[0].mean = mean;
    quality[0].standard_deviation = 0.001 * std::abs(mean);
    judge_together(channels, [&](std::size_t c) -> ChannelQuality& { return quality[c]; });
    return quality[0].findings;
  };
  CHECK(has(axis("acc_z", 1.0, "m/s^2"), "not_gravity"));
  CHECK(has(axis("acc_x", 9.8, "g"), "not_gravity"));
  CHECK(axis("acc_z", 9.8, "m/s^2").empty());
  CHECK(axis("acc_z", -1, "g").empty());
  for (const double tilted : {0.0, 0.3, 1.0, 4.9}) CHECK(axis("acc_x", tilted, "m/s^2").empty());
  CHECK(axis("acc_z", 4.9, "m/s^2").empty());
}

TEST_CASE("gravity: other quantities and names without axes are not judged") {
  Scene one = triad(1, "m/s^2", 0.001);
  for (ChannelQuality& q : one.quality) q.findings.clear();
  for (std::size_t c = 0; c < 3; ++c) one.channels[c].name = "temperature " + std::to_string(c);
  judge_together(one.channels, [&](std::size_t c) -> ChannelQuality& { return one.quality[c]; });
  CHECK(one.quality[0].findings.empty());
  CHECK(scale(triad(1, "rad/s", 0.001)) == "none");
}

TEST_CASE("gravity: the columns of an array are axes") {
  Scene array = triad(1, "m/s^2", 0.001);
  for (std::size_t c = 0; c < 3; ++c) {
    array.quality[c].findings.clear();
    array.channels[c].name = "acc_" + std::string(1, static_cast<char>('0' + c));
  }
  judge_together(array.channels, [&](std::size_t c) -> ChannelQuality& { return array.quality[c]; });
  CHECK(array.quality[0].findings.size() == 1);
}

TEST_CASE("the field of the Earth: a sound magnetometer has no finding, and one in another unit is named") {
  const auto field = [](double z, const std::string& unit) { return triad(z, unit, 0.01 * z, "mag_"); };
  for (const double iron : {8.0, 25.0, 48.0, 65.0, 250.0}) CHECK(scale(field(iron, "uT")) == "none");
  CHECK(scale(field(0.48, "Gauss")) == "none");
  CHECK(scale(field(48, "T")) == "mag_x=1/1e+06");
  CHECK(field(48, "T").quality[0].findings[0].severity == Severity::bad);
  CHECK(scale(field(48000, "uT")) == "mag_x=1/1000");
  CHECK(scale(field(480, "uT")) == "mag_x=1/10");
  CHECK(field(480, "uT").quality[0].findings[0].severity == Severity::caution);
  CHECK(scale(field(0.48, "uT")) == "mag_x=100");
  CHECK(scale(field(3000, "uT")) == "none");           // a magnet
  CHECK(scale(triad(48, "T", 20, "mag_")) == "none");  // it turns
  CHECK(scale(triad(0, "T", 1, "mag_")) == "none");    // noise alone
  CHECK(scale(triad(4.8e-5, "T", 1e-7, "mag_")) == "none");
}

TEST_CASE("a channel that is another one is named, also with its sign turned") {
  const auto of = [](const std::vector<double>& samples) {
    QualityMeter meter;
    meter.push(samples);
    return meter.finish();
  };
  test::Gaussian gauss(3);
  std::vector<double> a(5000), b(a.size()), turned(a.size()), coarse(a.size());
  for (std::size_t t = 0; t < a.size(); ++t) {
    a[t] = 0.3 + gauss();
    b[t] = 0.3 + gauss();
    turned[t] = -a[t];
    coarse[t] = static_cast<double>(t % 2);
  }
  std::vector<double> nearly = a;
  nearly[4000] += 1e-9;
  std::vector<ChannelQuality> quality = {of(a), of(b), of(a), of(turned), of(nearly), of(coarse), of(coarse)};
  std::vector<Channel> channels;
  for (const char* name : {"a", "b", "again", "turned", "nearly", "coarse", "switch"})
    channels.push_back({name, "deg/s", false});
  judge_together(channels, [&](std::size_t c) -> ChannelQuality& { return quality[c]; });
  std::string said;
  for (std::size_t c = 0; c < quality.size(); ++c)
    if (has(quality[c].findings, "copied_channel")) said += channels[c].name + " ";
  CHECK(said == "again turned ");
  CHECK(quality[3].findings.back().sentence.find("a with its sign turned") != std::string::npos);
  CHECK(quality[2].findings.back().help[0].options[0].value == "!again");
}

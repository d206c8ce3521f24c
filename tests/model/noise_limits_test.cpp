// Limits of data sheets: their file, and which channel they hold for.

#include "libchar/model/noise_limits.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "libchar/core/error.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

const std::vector<NamedChannel> kImu = {{"gx", "deg/s"}, {"gy", "deg/s"}, {"ax", "m/s^2"}};

std::vector<ChannelLimit> limits_of(const std::string& blocks, const std::vector<NamedChannel>& channels = kImu) {
  return limits_for(parse_limits("format: noise-limits\nversion: 1\nlimits:\n" + blocks, "sheet.yaml"), channels);
}

std::string limits_refusal(const std::string& blocks, const std::vector<NamedChannel>& channels = kImu) {
  try {
    limits_of(blocks, channels);
  } catch (const Error& error) {
    CHECK(error.problem().kind == ErrorKind::input);
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("limits are converted from the units of data sheets to the channel's") {
  const auto found = limits_of(
      "  - kind: angular_rate\n"
      "    white_noise: {value: 0.3, unit: deg/√h}\n"
      "    bias_instability: {value: 8, unit: deg/h, reading: floor}\n"
      "  - channels: ax\n"
      "    density: one-sided\n"
      "    white_noise: {value: 200, unit: µg/√Hz}\n"
      "    bias_instability: {value: 40, unit: µg}\n");
  REQUIRE(found.size() == 6);
  CHECK(found[0].channel == 0);
  CHECK(found[0].term == Term::white);
  CHECK(found[0].most == Approx(0.005).epsilon(1e-12));
  CHECK(found[0].text == "0.3 deg/√h");
  CHECK(found[1].term == Term::flicker);
  CHECK(found[1].most == Approx(8.0 / 3600 / std::sqrt(2 * std::numbers::ln2 / std::numbers::pi)).epsilon(1e-12));
  CHECK(found[3].channel == 1);
  CHECK(found[4].channel == 2);
  CHECK(found[4].most == Approx(200e-6 * 9.80665 / std::numbers::sqrt2).epsilon(1e-12));
  CHECK(found[5].most == Approx(40e-6 * 9.80665).epsilon(1e-12));
}

TEST_CASE("limits without a kind hold for every channel, in its own unit") {
  const auto found = limits_of("  - white_noise: {value: 2, unit: U·√s}\n", {{"a", "V"}, {"b", ""}});
  REQUIRE(found.size() == 2);
  CHECK(found[0].most == 2);
  CHECK(found[1].most == 2);
}

TEST_CASE("limits that cannot be used are refused at their line and column") {
  CHECK_THAT(limits_refusal("  - white_nose: 1\n"),
             Contains("sheet.yaml:4:5") && Contains("did you mean white_noise?"));
  CHECK_THAT(limits_refusal("  - white_noise: {value: 1, unit: deg/√h, status: given}\n    kind: angular_rate\n"),
             Contains("sheet.yaml:4:45") && Contains("unknown key"));
  CHECK_THAT(
      limits_refusal("  - {kind: angular_rate, white_noise: {value: 1, unit: mg}}\n"),
      Contains("sheet.yaml:4:") && Contains("not a unit of white_noise for a channel in deg/s") && Contains("deg/√h"));
  CHECK_THAT(limits_refusal("  - {kind: angular_rate, white_noise: {value: 1, unit: deg/s/√Hz}}\n"),
             Contains("one-sided or two-sided"));
  CHECK_THAT(limits_refusal("  - {channels: [gx, gz], bias_instability: {value: 1, unit: deg/h}}\n"),
             Contains("sheet.yaml:4:21") && Contains("no such channel") && Contains("gz"));
  CHECK_THAT(limits_refusal("  - {kind: pressure, bias_instability: {value: 1, unit: Pa}}\n"),
             Contains("sheet.yaml:4:12") && Contains("limits of another sensor?"));
  CHECK_THAT(limits_refusal("  - {kind: presure, bias_instability: {value: 1, unit: Pa}}\n"),
             Contains("did you mean pressure?"));
  CHECK_THAT(limits_refusal("  - {kind: angular_rate, channels: gx, bias_instability: {value: 1, unit: deg/h}}\n"),
             Contains("exclude each other"));
  CHECK_THAT(limits_refusal("  - {channels: gx, bias_instability: {value: 1, unit: deg/h}}\n"
                            "  - {kind: angular_rate, bias_instability: {value: 2, unit: deg/h}}\n"),
             Contains("sheet.yaml:5:") && Contains("already, in line 4"));
  CHECK_THAT(limits_refusal("  - {kind: angular_rate}\n"), Contains("limits no noise term"));
  CHECK_THAT(limits_refusal("  - {kind: angular_rate, bias_instability: {value: 0, unit: deg/h}}\n"),
             Contains("sheet.yaml:4:"));
  CHECK_THAT(limits_refusal("  - {kind: angular_rate, bias_instability: {unit: deg/h}}\n"),
             Contains("value is missing"));
  CHECK_THAT(limits_refusal("  []\n"), Contains("at least one limit"));
  CHECK_THROWS_WITH(parse_limits("format: sensor-model\nversion: 1\n", "m.yaml"), Contains("noise-limits"));
  CHECK_THROWS_WITH(parse_limits("format: noise-limits\nversion: 1\n", "m.yaml"), Contains("limits is missing"));
}

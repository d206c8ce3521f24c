// Devices side by side.

#include "libchar/characterize/lot.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/core/error.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

// A device of axes, made of numbers: a lot looks at coefficients, not at samples.
Characterization device(const std::string& file,
                        const std::vector<std::string>& axes,
                        double spread,
                        test::Gaussian& gauss) {
  Characterization out;
  out.log.file = file;
  out.log.time.rate_hz = 100;
  for (const std::string& axis : axes) {
    ChannelResult c;
    c.channel = {axis, "deg/s"};
    c.fit.emplace();
    c.fit->rate_hz = 100;
    c.fit->samples = 100000;
    Coefficient& white = c.fit->term[0];
    white.status = Status::detected;
    white.relative_sd = 0.01;
    white.value = 5e-3 * std::exp(spread * gauss() + 0.01 * gauss());
    white.ci95 = {*white.value * 0.98, *white.value * 1.02};
    c.fit->theta[0] = *white.value * *white.value;
    Coefficient& flicker = c.fit->term[1];
    flicker.status = Status::not_detected;
    flicker.upper95 = 1e-3;
    c.quality.mean = 0.5 * gauss();
    out.channels.push_back(std::move(c));
  }
  return out;
}

std::vector<Characterization> lot(std::size_t count, double spread, std::uint64_t seed) {
  test::Gaussian gauss(seed);
  std::vector<Characterization> out;
  for (std::size_t i = 0; i < count; ++i)
    out.push_back(device("lot/imu" + std::to_string(i) + ".csv", {"x", "y", "z"}, spread, gauss));
  return out;
}

const LotStatistic& find(const Lot& lot, const std::string& group, std::optional<Term> term) {
  for (const LotStatistic& s : lot.statistics)
    if (s.group == group && s.term == term) return s;
  FAIL("no statistic of " << group);
  return lot.statistics[0];
}

}  // namespace

TEST_CASE("a lot has a mean and a spread for each channel and for all of a kind") {
  const auto devices = lot(8, 0.1, 1);
  const Lot result = lot_of(devices);
  CHECK(result.devices[3] == "imu3");
  const LotStatistic& all = find(result, "angular_rate in deg/s", Term::white);
  CHECK(all.members == 24);
  CHECK(all.counted.size() == 24);
  const LotFigures figures = all.figures.value();
  CHECK(std::abs(std::log(figures.mean / 5e-3)) < 4 * 0.1 / std::sqrt(24));
  CHECK(std::log(figures.mean_ci95.high / figures.mean) ==
        Approx(2.07 * 0.1 / std::sqrt(24)).epsilon(0.4));
  CHECK(figures.spread_ci95.low < 0.1);
  CHECK(figures.spread_ci95.low > 0.04);
  CHECK(figures.spread_ci95.high > 0.1);
  CHECK(find(result, "y", Term::white).members == 8);
  const LotStatistic& means = find(result, "y", std::nullopt);
  CHECK(means.unit == "deg/s");
  CHECK(means.figures->spread_ci95.high > 0.5);
  CHECK_THAT(result.verdict, Contains("no channel stands out"));
}

TEST_CASE("a lot counts what was not detected, and gives it no mean") {
  const Lot result = lot_of(lot(4, 0, 2));
  const LotStatistic& flicker = find(result, "x", Term::flicker);
  CHECK(flicker.not_detected == 4);
  CHECK(flicker.counted.empty());
  CHECK_FALSE(flicker.figures);
}

TEST_CASE("a lot of equal devices bounds their spread and names none of them") {
  int named = 0;
  for (std::uint64_t seed = 10; seed < 50; ++seed) {
    const Lot result = lot_of(lot(6, 0, seed));
    const LotFigures figures = find(result, "angular_rate in deg/s", Term::white).figures.value();
    CHECK(figures.spread_ci95.high < 0.03);
    for (const LotStatistic& s : result.statistics) named += s.outliers.empty() ? 0 : 1;
  }
  CHECK(named <= 3);  // 1 % of 40 lots; more than three by chance: 0.1 %
}

TEST_CASE("a device that does not belong to the lot is named with its reason") {
  auto devices = lot(8, 0.03, 3);
  Coefficient& bad = devices[5].channels[1].fit->term[0];
  *bad.value *= 1.6;
  const Lot result = lot_of(devices);
  const LotStatistic& s = find(result, "y", Term::white);
  REQUIRE(s.outliers.size() == 1);
  CHECK(s.outliers[0].member.device == 5);
  CHECK(s.outliers[0].ratio == Approx(1.6).epsilon(0.1));
  CHECK_THAT(s.outliers[0].sentence, Contains("y of imu5") && Contains("times that of the others"));
  CHECK_THAT(result.verdict, Contains("1 channel stands out"));
}

TEST_CASE("a lot of one device compares its axes, one channel is none, one file twice is refused") {
  auto devices = lot(1, 0.1, 4);
  const Lot axes = lot_of(devices);
  CHECK(find(axes, "angular_rate in deg/s", Term::white).members == 3);
  devices[0].channels.resize(1);
  CHECK_THROWS_WITH(lot_of(devices), Contains("one channel is no lot"));
  devices = lot(2, 0, 5);
  devices[0].log.sha256 = devices[1].log.sha256 = "ab";
  CHECK_THROWS_WITH(lot_of(devices), Contains("same recording"));
}

TEST_CASE("channels of one name in unlike units are not taken together") {
  auto devices = lot(2, 0, 6);
  for (ChannelResult& c : devices[1].channels) c.channel.unit = "rad/s";
  const Lot result = lot_of(devices);
  for (const LotStatistic& s : result.statistics) CHECK(s.group != "x");
}

TEST_CASE("lot: channels of one name and unlike units are named and not compared") {
  test::Gaussian gauss(8);
  std::vector<Characterization> lot = {device("a.csv", {"x", "y"}, 0.1, gauss),
                                       device("b.csv", {"x", "y"}, 0.1, gauss)};
  lot[1].channels[1].channel.unit = "rad/s";
  const Lot found = lot_of(lot);
  REQUIRE(found.not_compared.size() == 1);
  CHECK_THAT(found.verdict, Contains("y is in deg/s in a and in rad/s in b: not compared."));
  lot[1].channels[1].channel.unit = "deg/s";
  CHECK(lot_of(lot).not_compared.empty());
}

// A fleet's devices side by side.

#include "libchar/lot/fleet_lot.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/text/readable.hpp"
#include "tests/lot/made_fleet.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

const QuantityLot& find(const FleetLot& lot, const std::string& group, DeviceQuantity quantity,
                        const std::string& type = "mems") {
  for (const QuantityLot& q : lot.quantities)
    if (q.group == group && q.quantity == quantity && q.type == type) return q;
  FAIL("no such quantity of " << group);
  return lot.quantities[0];
}

NoiseLimits limits(const std::string& value) {
  return parse_limits(
      "format: noise-limits\nversion: 1\nlimits:\n  - channels: [gyro_x]\n    bias_instability: {value: " + value +
          ", unit: deg/s}\n",
      "limits.yaml");
}

bool holds(const Interval& i, double value) { return i.low <= value && value <= i.high; }

}  // namespace

TEST_CASE("a fleet has mean, spread, quantiles and a chart of each quantity, a kind of its logarithms") {
  const auto records = test::made_lot({}, 1);
  const FleetLot lot = fleet_lot(records);
  CHECK(lot.devices == 200);
  const QuantityLot& b = find(lot, "gyro_x", DeviceQuantity::bias_instability);
  CHECK(b.counts.members == 200);
  CHECK(b.counts.counted == 200);
  CHECK(b.figures->mean == Approx(2e-3).epsilon(0.06));
  CHECK(b.figures->spread == Approx(0.2).epsilon(0.25));
  CHECK(b.quantiles[3] == Approx(2e-3).epsilon(0.06));
  CHECK(b.quantiles[0] <= b.quantiles[1]);
  std::uint64_t inside = b.histogram.below + b.histogram.above;
  for (const auto n : b.histogram.count) inside += n;
  CHECK(inside == 200);
  REQUIRE(b.chart);
  CHECK(b.chart->centre == Approx(std::log(2e-3)).epsilon(0.01));
  // From device to device: their spread and the uncertainty of each.
  CHECK(b.chart->sigma == Approx(std::hypot(0.2, 0.1)).epsilon(0.2));
  const QuantityLot& kind = find(lot, "angular_rate in deg/s", DeviceQuantity::bias_instability);
  CHECK(kind.counts.members == 400);
  CHECK_FALSE(kind.chart);
  const QuantityLot& bias = find(lot, "gyro_y", DeviceQuantity::turn_on_bias);
  CHECK(bias.unit == "deg/s");
  CHECK(bias.figures->spread == Approx(0.1).epsilon(0.2));
  CHECK(lot.verdict == "200 devices. No device is an outlier.");
}

TEST_CASE("the spread of devices is not the uncertainty of one") {
  test::MadeLot made;
  made.spread[2] = 0;
  const FleetLot lot = fleet_lot(test::made_lot(made, 2));
  const QuantityLot& k = find(lot, "gyro_x", DeviceQuantity::random_walk);
  // Values scatter by a quarter, devices do not.
  CHECK(std::log(k.quantiles[5] / k.quantiles[1]) > 0.8);
  CHECK(k.figures->spread < 0.12);
  CHECK(k.figures->spread_ci95.low == 0);
}

TEST_CASE("a fleet's result does not depend on the order of its records") {
  test::MadeLot other;
  other.batch = "2";
  other.prefix = "b";
  auto records = test::made_lot({}, 3);
  test::append(records, test::made_lot(other, 4));
  const FleetLot before = fleet_lot(records);
  std::vector<std::string> devices;
  for (const std::size_t r : before.order) devices.push_back(records[r].device);
  std::reverse(records.begin(), records.end());
  std::swap(records[3], records[170]);
  const FleetLot after = fleet_lot(records);
  REQUIRE(after.quantities.size() == before.quantities.size());
  for (std::size_t q = 0; q < after.quantities.size(); ++q) {
    CHECK(after.quantities[q].group == before.quantities[q].group);
    CHECK(after.quantities[q].figures->mean == before.quantities[q].figures->mean);
    CHECK(after.quantities[q].figures->spread_ci95.high == before.quantities[q].figures->spread_ci95.high);
    if (after.quantities[q].batch_difference)
      CHECK(after.quantities[q].batch_difference->p == before.quantities[q].batch_difference->p);
  }
  for (std::size_t i = 0; i < devices.size(); ++i) CHECK(records[after.order[i]].device == devices[i]);
  CHECK(devices[1] == "imu2");
  CHECK(devices[9] == "imu10");
}

TEST_CASE("a device that does not belong to its fleet is named with its reason, the worst first") {
  auto records = test::made_lot({}, 5);
  records[16].channels[1].values[0].value *= 1.5;
  records[40].channels[0].values[1].value *= 9;
  const FleetLot lot = fleet_lot(records);
  REQUIRE(lot.worst.size() == 2);
  CHECK(lot.outlying == 2);
  CHECK(records[lot.worst[0].recording].device == "imu41");
  CHECK_THAT(lot.worst[0].reasons[0], Contains("gyro_x: Bias instability") && Contains(" deg/h, ") &&
                                          Contains("times that of the others (p < 0.0001)"));
  // The number of the device's own report, not that of the comparison.
  CHECK_THAT(lot.worst[0].reasons[0],
             Contains(" " + number_text(records[40].channels[0].values[1].value * 3600) + " deg/h, "));
  CHECK(find(lot, "gyro_y", DeviceQuantity::white_noise).outliers[0].ratio == Approx(1.5).epsilon(0.2));
  CHECK(lot.stands_out[16]);
  CHECK_FALSE(lot.stands_out[17]);
  CHECK_THAT(lot.verdict, Contains("2 devices are outliers of their kind: imu17, imu41."));
}

TEST_CASE("a device that is a little noisier in all of its channels stands out as a device") {
  int named = 0, others = 0, clean = 0;
  test::MadeLot made;
  made.devices = 6;
  made.channels = {"gyro_x", "gyro_y", "gyro_z"};
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    auto records = test::made_lot(made, 900 + seed);
    clean += fleet_lot(records).outlying > 0;
    for (RecordedChannel& c : records[2].channels) c.values[0].value *= 1.4;
    const FleetLot lot = fleet_lot(records);
    named += lot.stands_out[2];
    others += lot.outlying > (lot.stands_out[2] ? 1U : 0U);
    if (!lot.stands_out[2] || lot.outlying > 1) continue;
    CHECK(lot.verdict == "6 devices. 1 device is an outlier of its kind: imu3.");
    CHECK_THAT(lot.worst[0].reasons.back(), Contains("times that of the others"));
  }
  CHECK(named >= 60);
  CHECK(others <= 4);
  CHECK(clean <= 4);  // 1 is expected; more than 4 by chance: 0.4 %
}

TEST_CASE("what all channels of a device share is no alarm where every device has its own") {
  int named = 0;
  test::MadeLot made;
  made.devices = 8;
  made.spread[0] = 0.02;
  made.channels = {"a", "b", "c", "d", "e", "f"};
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    auto records = test::made_lot(made, 2900 + seed);
    test::Gaussian gauss(seed);
    for (DeviceRecord& r : records) {
      const double by = std::exp(0.1 * gauss());
      for (RecordedChannel& c : r.channels) c.values[0].value *= by;
    }
    named += fleet_lot(records).outlying > 0;
  }
  CHECK(named <= 8);
}

TEST_CASE("a fleet without a device that stands out names one in 1 %") {
  int named = 0;
  for (std::uint64_t seed = 100; seed < 300; ++seed) named += fleet_lot(test::made_lot({}, seed)).outlying > 0;
  CHECK(named <= 8);  // 2 are expected; more than 8 by chance: 0.02 %
}

TEST_CASE("means and spreads of a known lot lie in their intervals") {
  // 20 lots of 200 devices, 2 channels × 4 quantities: 320 intervals of means and of spreads. fleet_lot_bench has more.
  int means = 0, spreads = 0, all = 0;
  const test::MadeLot made;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const FleetLot lot = fleet_lot(test::made_lot(made, 7000 + seed));
    for (const QuantityLot& q : lot.quantities) {
      if (q.of_kind || !q.figures) continue;
      const bool bias = q.quantity == DeviceQuantity::turn_on_bias;
      const auto t = static_cast<std::size_t>(q.quantity);
      means += holds(q.figures->mean_ci95, bias ? made.bias : made.mean[t]);
      spreads += holds(q.figures->spread_ci95, bias ? made.bias_spread : made.spread[t]);
      ++all;
    }
  }
  REQUIRE(all == 160);
  // 93 to 97 % of 160, which scatter by 1.7 % themselves.
  CHECK(means >= 0.91 * all);
  CHECK(spreads >= 0.91 * all);
}

TEST_CASE("batches that differ are told apart, and their devices' spread is not the difference") {
  test::MadeLot second;
  second.batch = "2";
  second.prefix = "b";
  second.mean[1] *= 1.3;
  auto records = test::made_lot({}, 8);
  test::append(records, test::made_lot(second, 9));
  const FleetLot lot = fleet_lot(records);
  const QuantityLot& b = find(lot, "gyro_x", DeviceQuantity::bias_instability);
  REQUIRE(b.batches.size() == 2);
  CHECK(b.batches[1].figures->mean / b.batches[0].figures->mean == Approx(1.3).epsilon(0.08));
  REQUIRE(b.batch_difference);
  CHECK(b.batch_difference->p < 1e-6);
  CHECK(b.batch_difference->within == Approx(0.2).epsilon(0.2));
  CHECK(b.batch_difference->between == Approx(std::log(1.3) / std::sqrt(2)).epsilon(0.25));
  CHECK(find(lot, "gyro_x", DeviceQuantity::random_walk).batch_difference->p > 1e-4);
  CHECK_THAT(lot.verdict, Contains("in 2 batches") && Contains("Batches differ: Bias instability of") &&
                              Contains("Values change along the lot: Bias instability of gyro_"));
  CHECK_THAT(fleet_lot(test::made_lot({}, 8)).verdict, !Contains("Values change"));
}

TEST_CASE("recordings of one device say how its bias repeats") {
  auto records = test::made_lot({}, 10);
  test::Gaussian gauss(11);
  const std::size_t devices = records.size();
  for (std::size_t i = 0; i < devices; ++i) {
    DeviceRecord again = records[i];
    again.log = "again/" + again.device;
    again.sha256 += "again";
    for (RecordedChannel& c : again.channels) c.values[3].value += 0.03 * std::sqrt(2) * gauss();
    records.push_back(again);
  }
  const FleetLot lot = fleet_lot(records);
  CHECK(lot.devices == 200);
  CHECK(lot.order.size() == 400);
  const QuantityLot& bias = find(lot, "gyro_x", DeviceQuantity::turn_on_bias);
  CHECK(bias.counts.members == 200);
  REQUIRE(bias.repeats);
  CHECK(bias.repeats->devices == 200);
  CHECK(bias.repeats->within == Approx(0.03).epsilon(0.2));
  CHECK(holds(bias.figures->spread_ci95, 0.1));
}

TEST_CASE("a log that is there twice counts once") {
  auto records = test::made_lot({}, 12);
  records.push_back(records[3]);
  const FleetLot lot = fleet_lot(records);
  CHECK(lot.order.size() == 200);
  REQUIRE(lot.notes.size() == 1);
  CHECK_THAT(lot.notes[0], Contains("1 record of a log that is there already"));
}

TEST_CASE("versions that differ are told, of recordings that were characterized") {
  auto records = test::made_lot({}, 13);
  const auto told = [&] { return fmt::format("{}", fmt::join(fleet_lot(records).notes, " ")); };
  records[0].problem = "it is cut";
  records[0].program = records[0].settings = "";
  records[0].channels.clear();
  CHECK_THAT(told(), !Contains("versions"));
  records[1].program = "another";
  CHECK_THAT(told(), Contains("2 versions of the program"));
}

TEST_CASE("a bad finding keeps a value out of the lot, and is counted") {
  auto records = test::made_lot({}, 14);
  const QuantityLot before = find(fleet_lot(records), "gyro_x", DeviceQuantity::white_noise);
  for (std::size_t i = 0; i < 5; ++i) {
    RecordedChannel& channel = records[i].channels[0];
    for (RecordedValue& v : channel.values)
      if (v.quantity == DeviceQuantity::white_noise) v.value *= 100;
    channel.findings.push_back(finding("missing_mark", "0 is a mark"));
  }
  const FleetLot lot = fleet_lot(records);
  const QuantityLot& n = find(lot, "gyro_x", DeviceQuantity::white_noise);
  CHECK(n.counts.spoilt == 5);
  CHECK(n.counts.counted + 5 == before.counts.counted);
  REQUIRE(n.figures);
  CHECK(n.figures->mean == Approx(before.figures->mean).epsilon(0.05));
  // A mark is in the mean as well, and so are a wrong unit and a motion.
  for (const char* code : {"missing_mark", "moves_throughout"}) {
    for (std::size_t i = 0; i < 5; ++i) records[i].channels[0].findings = {finding(code, "not the sensor's own")};
    const FleetLot left = fleet_lot(records);
    CHECK(find(left, "gyro_x", DeviceQuantity::turn_on_bias).counts.spoilt == 5);
    // Who is left out is not called sound.
    CHECK_THAT(left.verdict, !Contains("is an outlier."));
  }
}

TEST_CASE("what is not detected, doubtful or without a fit is counted as that") {
  auto records = test::made_lot({}, 13);
  for (std::size_t i = 0; i < 100; ++i) {
    RecordedValue& v = records[i].channels[0].values[2];
    v.status = i < 90 ? Status::not_detected : Status::misfit;
    v.upper95 = 1e-3;
    if (i < 90) v.value = kNone;
  }
  records[150].channels[0].fitted = false;
  records[151].problem = "is empty";
  records[151].channels.clear();
  const FleetLot lot = fleet_lot(records);
  const QuantityLot& k = find(lot, "gyro_x", DeviceQuantity::random_walk);
  CHECK(k.counts.members == 199);
  CHECK(k.counts.counted == 98);
  CHECK(k.counts.not_detected == 90);
  CHECK(k.counts.doubtful == 10);
  CHECK(k.counts.no_result == 1);
  CHECK_FALSE(k.figures);
  CHECK(lot.failed == std::vector<std::size_t>{151});
  CHECK_THAT(lot.verdict, Contains("1 recording could not be characterized"));
}

TEST_CASE("units of one quantity are converted, unlike ones are not compared") {
  const auto in_degrees = test::made_lot({}, 14);
  const FleetLot one_unit = fleet_lot(in_degrees);
  auto records = in_degrees;
  records[0].channels[0].unit = "dps";
  for (std::size_t i = 1; i < 60; ++i) test::to_radians(records[i]);
  FleetLotOptions options;
  options.limits["mems"] = limits("2.5e-3");
  const FleetLot lot = fleet_lot(records, options);
  CHECK(lot.notes ==
        std::vector<std::string>{"gyro_x of mems, gyro_y of mems: recorded in deg/s, rad/s, compared in deg/s."});
  REQUIRE(lot.quantities.size() == one_unit.quantities.size());
  for (std::size_t q = 0; q < lot.quantities.size(); ++q) {
    const QuantityLot &a = lot.quantities[q], &b = one_unit.quantities[q];
    CAPTURE(a.group, a.unit);
    CHECK(a.group == b.group);
    CHECK(a.unit == b.unit);
    CHECK(a.counts.members == b.counts.members);
    REQUIRE(a.figures.has_value());
    CHECK(a.figures->mean == Approx(b.figures->mean).epsilon(1e-12));
    CHECK(a.figures->spread == Approx(b.figures->spread).epsilon(1e-9));
  }
  const FleetLot limited = fleet_lot(in_degrees, options);
  CHECK(lot.failing > 0);
  CHECK(lot.failing == limited.failing);
  CHECK(lot.open == limited.open);
  records[3].channels[0].unit = "V";
  const std::vector<std::string> notes = fleet_lot(records).notes;
  REQUIRE(notes.size() == 2);
  CHECK(notes[1] ==
        "gyro_x of mems has 2 units, V (imu4), deg/s (imu1, imu2, imu3 and 196 more): compared within each.");
}

TEST_CASE("scales of temperature with unlike zeros are not converted") {
  auto records = test::made_lot({}, 14);
  for (DeviceRecord& r : records)
    for (RecordedChannel& c : r.channels) c.unit = "K";
  records[1].channels[0].unit = "°C";
  CHECK(find(fleet_lot(records), "gyro_x", DeviceQuantity::turn_on_bias).counts.members == 199);
}

TEST_CASE("axes that differ in every device alike are no device's fault, of one device they are") {
  test::MadeLot made;
  made.channels = {"gx", "gy", "gz", "gu", "gv"};
  made.spread[0] = 0.02;
  made.devices = 12;
  auto records = test::made_lot(made, 23);
  const auto louder = [](DeviceRecord& r, std::size_t channel, double by) {
    r.channels[channel].values[0].value *= by;
  };
  for (DeviceRecord& r : records) louder(r, 2, 4);
  const FleetLot lot = fleet_lot(records);
  CHECK(lot.verdict == "12 devices. No device is an outlier.");
  CHECK(lot.worst.empty());
  records.resize(1);
  const FleetLot axes = fleet_lot(records);
  CHECK(axes.verdict == "1 device. 1 channel is an outlier of its kind: gz.");
  CHECK(axes.outlying == 0);
  const QuantityLot& kind = find(axes, "angular_rate in deg/s", DeviceQuantity::white_noise);
  REQUIRE(kind.outliers.size() == 1);
  CHECK(records[0].channels[kind.outliers[0].channel].name == "gz");
  CHECK(kind.outliers[0].ratio == Approx(4).epsilon(0.1));
  louder(records[0], 2, 0.25);
  CHECK(fleet_lot(records).verdict == "1 device. No channel is an outlier.");
}

TEST_CASE("two that stand out are each held against those that do not") {
  test::MadeLot made;
  made.devices = 10;
  made.spread[0] = 0;
  auto records = test::made_lot(made, 24);
  records[3].channels[0].values[0].value *= 1.9;
  records[7].channels[0].values[0].value *= 2.3;
  const FleetLot lot = fleet_lot(records);
  const QuantityLot& q = find(lot, "gyro_x", DeviceQuantity::white_noise);
  REQUIRE(q.outliers.size() == 2);
  CHECK(q.outliers[0].ratio == Approx(q.outliers[0].recording == 3 ? 1.9 : 2.3).epsilon(0.04));
  CHECK(q.outliers[1].ratio == Approx(q.outliers[1].recording == 3 ? 1.9 : 2.3).epsilon(0.04));
}

TEST_CASE("channels without a unit are no kind of their own") {
  auto records = test::made_lot({}, 14);
  for (std::size_t i = 0; i < 4; ++i)
    for (RecordedChannel& c : records[i].channels) c.unit = "";
  const FleetLot lot = fleet_lot(records);
  for (const QuantityLot& q : lot.quantities) CHECK((!q.of_kind || q.group == "angular_rate in deg/s"));
  CHECK(find(lot, "angular_rate in deg/s", DeviceQuantity::white_noise).counts.members == 392);
  REQUIRE(lot.notes.size() == 2);
  CHECK(lot.notes[0] ==
        "gyro_x of mems has 2 units, no unit (imu1, imu2, imu3 and 1 more), deg/s (imu5, imu6, imu7 and 193 more): "
        "compared within each.");
}

TEST_CASE("a device with recordings in two batches is of the first, and said so by name") {
  auto records = test::made_lot({}, 18);
  for (std::size_t i : {3, 11}) {
    records.push_back(records[i]);
    records.back().sha256 += "again";
    records.back().log = "a/again.csv";  // before the others, if the batch did not count
    records.back().batch = i == 3 ? "2" : "10";
  }
  for (std::size_t i = 20; i < 40; ++i) records[i].batch = "2";
  records[5].batch = "";
  const FleetLot lot = fleet_lot(records);
  CHECK(lot.devices == 200);
  CHECK(lot.batches == std::vector<std::string>{"", "1", "2"});
  CHECK(batch_of(lot, 200) == "1");
  CHECK(batch_of(lot, 201) == "1");
  CHECK(find(lot, "gyro_x", DeviceQuantity::white_noise).batches[1].counts.members == 179);
  REQUIRE(lot.notes.size() == 1);
  CHECK(lot.notes[0] ==
        "2 devices have recordings in several batches, and count in the first of them: imu4 (batch 1, batch 2), imu12 "
        "(batch 1, batch 10).");
  // What one recording does not state, another may.
  records[11].batch = "";
  CHECK(device_batches(records).batch[11] == "10");
}

TEST_CASE("devices are held against limits, and the lot's capability is that of its distribution") {
  const auto records = test::made_lot({}, 15);
  FleetLotOptions options;
  options.limits[""] = limits("3e-3");
  const FleetLot lot = fleet_lot(records, options);
  const QuantityLot& b = find(lot, "gyro_x", DeviceQuantity::bias_instability);
  REQUIRE(b.capability);
  const Capability& c = *b.capability;
  CHECK(c.pass + c.fail + c.not_decided == 200);
  CHECK(c.fail > 0);
  const double ppk = std::log(1.5) / (3 * 0.2);
  CHECK(c.ppk.value() == Approx(ppk).epsilon(0.2));
  CHECK(holds(c.ppk_ci95, ppk));
  CHECK(c.above == Approx(std::erfc(3 * c.ppk.value() / std::sqrt(2.0)) / 2));
  CHECK(c.cpk.value() < c.ppk.value());
  CHECK(lot.failing == c.fail);
  CHECK(lot.open == c.not_decided);
  CHECK(lot.worst.size() == c.fail);
  CHECK_THAT(lot.worst[0].reasons[0], Contains("allowed 3e-3 deg/s (0.003000 deg/s)"));
  CHECK_FALSE(find(lot, "gyro_y", DeviceQuantity::bias_instability).capability);
  CHECK_THAT(lot.verdict, Contains(fmt::format("Of 200 devices compared with limits, {} fail", c.fail)) &&
                              Contains(fmt::format("{} not decided, {} keep all of them.", c.not_decided, c.pass)));
}

TEST_CASE("a fleet of nothing, and limits of a type that is not there, are refused") {
  CHECK_THROWS_WITH(fleet_lot({}), Contains("E0752") && Contains("at least one device record"));
  FleetLotOptions options;
  options.limits["fog"] = limits("3e-3");
  CHECK_THROWS_WITH(fleet_lot(test::made_lot({}, 16), options), Contains("E0751") && Contains("the types are mems"));
}

TEST_CASE("one device is a fleet without statistics") {
  test::MadeLot made;
  made.devices = 1;
  const FleetLot lot = fleet_lot(test::made_lot(made, 17));
  CHECK_FALSE(find(lot, "gyro_x", DeviceQuantity::white_noise).figures);
  CHECK(lot.verdict == "1 device. Too few of a kind to find outliers: at least 4 are needed.");
}

TEST_CASE("a result that is not there yet is no failure, and where there is none nobody is judged") {
  auto records = test::made_lot({}, 19);
  records.resize(4);
  for (DeviceRecord& r : records) r.channels.clear();
  records[0].problem = "is empty";
  for (std::size_t i = 1; i < 4; ++i) {
    records[i].problem = "its result is not there yet";
    records[i].awaited = true;
  }
  const FleetLot lot = fleet_lot(records);
  CHECK(lot.failed == std::vector<std::size_t>{0});
  CHECK(lot.awaited == std::vector<std::size_t>{1, 2, 3});
  CHECK(lot.verdict ==
        "4 devices: 1 recording could not be characterized, of 3 recordings the result is not there yet. There is no "
        "result to judge.");
}

// Two lots side by side.

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/lot/fleet_lot.hpp"
#include "tests/lot/made_fleet.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

const LotDifference& find(const FleetComparison& c, const std::string& group, DeviceQuantity quantity) {
  for (const LotDifference& d : c.differences)
    if (d.group == group && d.quantity == quantity) return d;
  FAIL("no such quantity of " << group);
  return c.differences[0];
}

bool any(const FleetComparison& c) {
  for (const LotDifference& d : c.differences)
    if (d.mean_differs || d.spread_differs) return true;
  return false;
}

}  // namespace

TEST_CASE("lots that are alike differ in 5 % of comparisons") {
  for (const std::size_t devices : {5, 40}) {
    test::MadeLot made;
    made.devices = devices;
    int alarms = 0;
    constexpr int kLots = 400;
    for (std::uint64_t i = 0; i < kLots; ++i)
      alarms += any(compare_lots(test::made_lot(made, 20000 + 2 * i), test::made_lot(made, 20001 + 2 * i)));
    CAPTURE(devices, alarms);
    CHECK(alarms <= 0.093 * kLots);  // 5 % and four standard deviations
  }
}

TEST_CASE("lots that are alike and not normal differ no more often than that") {
  // Devices of two kinds make heavy tails: every tenth scatters four times as far.
  int alarms = 0;
  constexpr int kLots = 300;
  test::Gaussian gauss(5);
  for (std::uint64_t i = 0; i < kLots; ++i) {
    test::MadeLot made, wide;
    made.devices = 54;
    wide.devices = 6;
    wide.prefix = "w";
    for (double& s : wide.spread) s *= 4;
    wide.bias_spread *= 4;
    auto a = test::made_lot(made, 40000 + 4 * i), b = test::made_lot(made, 40001 + 4 * i);
    test::append(a, test::made_lot(wide, 40002 + 4 * i));
    test::append(b, test::made_lot(wide, 40003 + 4 * i));
    alarms += any(compare_lots(a, b));
  }
  CAPTURE(alarms);
  CHECK(alarms <= 0.1 * kLots);
}

TEST_CASE("lots that differ are told apart, by how much and with which probability") {
  test::MadeLot made, other;
  made.devices = other.devices = 50;
  other.mean[0] *= 1.08;
  other.spread[1] *= 2;
  other.bias += 0.2;
  int white = 0, flicker = 0, bias = 0, covered = 0, wrong = 0;
  constexpr int kLots = 100;
  for (std::uint64_t i = 0; i < kLots; ++i) {
    const FleetComparison c = compare_lots(test::made_lot(made, 60000 + 2 * i), test::made_lot(other, 60001 + 2 * i));
    const LotDifference& n = find(c, "gyro_x", DeviceQuantity::white_noise);
    white += n.mean_differs;
    wrong += n.spread_differs;
    covered += n.change_ci95.low <= 1.08 && 1.08 <= n.change_ci95.high;
    flicker += find(c, "gyro_y", DeviceQuantity::bias_instability).spread_differs;
    bias += find(c, "gyro_y", DeviceQuantity::turn_on_bias).mean_differs;
  }
  CHECK(white >= 95);
  CHECK(flicker >= 80);
  CHECK(bias >= 99);
  CHECK(covered >= 86);
  CHECK(wrong <= 4);
}

TEST_CASE("a comparison says what differs in sentences") {
  test::MadeLot made, other;
  other.mean[0] *= 1.08;
  other.mean[1] *= 3;
  other.bias_spread *= 2;
  const FleetComparison c =
      compare_lots(test::made_lot(made, 1), test::made_lot(other, 2), {.name_a = "March", .name_b = "April"});
  CHECK(c.tests == 16);
  const LotDifference& n = find(c, "gyro_x", DeviceQuantity::white_noise);
  CHECK_THAT(n.sentence, Contains("gyro_x of mems: White noise of April is ") &&
                             Contains(" % larger than of March [") && Contains("p < 0.0001"));
  CHECK_THAT(find(c, "gyro_x", DeviceQuantity::bias_instability).sentence, Contains("times that of March"));
  CHECK_THAT(find(c, "gyro_x", DeviceQuantity::turn_on_bias).sentence,
             Contains("devices of April scatter by") && Contains("deg/s"));
  CHECK_THAT(find(c, "gyro_x", DeviceQuantity::random_walk).sentence, Contains("no difference is resolved"));
  CHECK_THAT(c.verdict, Contains("16 tests: 6 of 8 quantities differ."));
}

TEST_CASE("Holm: the probabilities of all are those of each times the tests that are left, in order") {
  const FleetComparison c = compare_lots(test::made_lot({}, 1), test::made_lot({}, 2));
  std::vector<std::pair<double, double>> p;
  for (const LotDifference& d : c.differences) {
    p.emplace_back(d.p_mean, d.p_mean_of_all);
    p.emplace_back(d.p_spread, d.p_spread_of_all);
  }
  std::sort(p.begin(), p.end());
  CHECK(p[0].second == Approx(std::min(1.0, 16 * p[0].first)));
  for (std::size_t i = 1; i < p.size(); ++i) {
    CHECK(p[i].second >= p[i - 1].second);
    CHECK(p[i].second >= std::min(1.0, p[i].first));
  }
}

TEST_CASE("what cannot be compared is said, and lots without a common channel are refused") {
  auto a = test::made_lot({}, 1);
  test::MadeLot made;
  made.channels = {"gyro_x", "gyro_z"};
  auto b = test::made_lot(made, 2);
  for (DeviceRecord& r : b) {
    r.channels[0].values[1].status = Status::not_detected;
    r.channels[0].values[1].value = kNone;
  }
  const FleetComparison c = compare_lots(a, b);
  REQUIRE(c.not_compared.size() == 3);
  CHECK_THAT(c.not_compared[0],
             Contains("200 of 200 devices of A and of 0 of 200 devices of B: too few of B for means."));
  CHECK(c.not_compared[1] == "gyro_y of mems in deg/s: only in A.");
  CHECK(c.not_compared[2] == "gyro_z of mems in deg/s: only in B.");
  for (DeviceRecord& r : b) r.type = "fog";
  CHECK_THROWS_WITH(compare_lots(a, b), Contains("E0753") && Contains("no channel"));
  CHECK_THROWS_WITH(compare_lots(a, {}), Contains("E0752") && Contains("none in B"));
}

TEST_CASE("lots in several units of one quantity are compared in that of the first") {
  test::MadeLot made;
  made.devices = 30;
  const auto a = test::made_lot(made, 71);
  auto b = test::made_lot(made, 72);
  const FleetComparison same = compare_lots(a, b, {.name_a = "May", .name_b = "June"});
  for (DeviceRecord& r : b) test::to_radians(r);
  const FleetComparison c = compare_lots(a, b, {.name_a = "May", .name_b = "June"});
  REQUIRE(c.notes.size() == 2);
  CHECK(c.notes[0] == "gyro_x of mems is in deg/s in May and in rad/s in June: compared in deg/s.");
  REQUIRE(c.differences.size() == same.differences.size());
  for (std::size_t i = 0; i < c.differences.size(); ++i) {
    CHECK(c.differences[i].unit == same.differences[i].unit);
    CHECK(c.differences[i].change == Approx(same.differences[i].change).epsilon(1e-9));
    CHECK(c.differences[i].p_mean == Approx(same.differences[i].p_mean).epsilon(1e-6));
  }
}

TEST_CASE("two batches have the means that the report of their lot gives them") {
  test::MadeLot made;
  made.devices = 12;
  auto both = test::made_lot(made, 81);
  made.batch = "2";
  made.prefix = "new";
  test::append(both, test::made_lot(made, 82));
  for (std::size_t i = 0; i < both.size(); i += 4)
    for (RecordedChannel& c : both[i].channels) {
      RecordedValue& k = c.values[2];
      k.in_all = SquareInAll{0.5 * k.value * k.value, k.value * k.value, 0.5};
      k.status = Status::not_detected;
      k.upper95 = 2 * k.value;
      k.value = kNone;
    }
  const std::span<const DeviceRecord> records = both;
  const FleetComparison c = compare_lots(records.first(12), records.last(12));
  const FleetLot lot = fleet_lot(both);
  for (const QuantityLot& q : lot.quantities) {
    if (q.of_kind) continue;
    CAPTURE(q.group, title_of(q.quantity));
    const LotDifference& d = find(c, q.group, q.quantity);
    REQUIRE(q.batches.size() == 2);
    CHECK(q.batches[0].figures->mean == d.a.mean);
    CHECK(q.batches[1].figures->mean == d.b.mean);
    CHECK(q.batches[1].figures->spread == d.b.spread);
    const bool of_all = q.quantity == DeviceQuantity::random_walk;
    CHECK(q.batches[0].in_figures == (of_all ? 12 : q.batches[0].counts.counted));
  }
}

TEST_CASE("lots of two devices are compared as far as two devices go") {
  test::MadeLot made;
  made.devices = 2;
  const FleetComparison c = compare_lots(test::made_lot(made, 1), test::made_lot(made, 2));
  CHECK(c.tests == 16);
  for (const LotDifference& d : c.differences) CHECK(d.p_spread == 1);
}

// Devices that were recorded at several temperatures: their coefficients, and their bias without them.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/lot/fleet_lot.hpp"
#include "tests/lot/made_fleet.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

const QuantityLot* find(const FleetLot& lot, DeviceQuantity quantity) {
  for (const QuantityLot& q : lot.quantities)
    if (q.group == "gyro_x" && !q.of_kind && q.quantity == quantity) return &q;
  return nullptr;
}

bool contains(const Interval& i, double value) { return i.low <= value && value <= i.high; }

test::MadeLot of_devices(std::size_t count) {
  test::MadeLot made;
  made.devices = count;
  made.channels = {"gyro_x"};
  return made;
}

RecordedValue found_inside(double value) {
  RecordedValue out;
  out.quantity = DeviceQuantity::temperature_coefficient;
  out.value = value;
  out.sd = 1e-4;
  out.ci95 = {value - 2e-4, value + 2e-4};
  return out;
}

}  // namespace

TEST_CASE("coefficients by recordings at several temperatures hold the truth") {
  // 60 lots of 12 devices; fleet_lot_bench has more.
  const test::MadeTemperatures how;
  int device = 0, mean = 0, spread = 0, repeat = 0;
  constexpr int kLots = 60, kDevices = 12;
  for (std::uint64_t i = 0; i < kLots; ++i) {
    const auto drawn = test::made_temperature_lot(of_devices(kDevices), how, 300 + i);
    const FleetLot lot = fleet_lot(drawn.records);
    const QuantityLot* tc = find(lot, DeviceQuantity::temperature_coefficient);
    const QuantityLot* bias = find(lot, DeviceQuantity::turn_on_bias);
    REQUIRE(tc != nullptr);
    REQUIRE(tc->temperatures);
    REQUIRE(tc->temperatures->slopes.size() == kDevices);
    for (std::size_t d = 0; d < kDevices; ++d) device += contains(tc->temperatures->slopes[d].ci95, drawn.slope[d]);
    mean += contains(tc->figures->mean_ci95, how.slope);
    spread += contains(tc->figures->spread_ci95, how.slope_spread);
    repeat += contains(bias->repeats->within_ci95, how.scatter);
  }
  // 95 % less four standard deviations of these counts.
  CHECK(device >= 0.917 * kLots * kDevices);
  CHECK(device <= 0.983 * kLots * kDevices);
  CHECK(mean >= 0.84 * kLots);
  CHECK(spread >= 0.84 * kLots);
  CHECK(repeat >= 0.84 * kLots);
}

TEST_CASE("temperature does not make the bias repeat worse, and the bias is that at one temperature") {
  test::MadeTemperatures how;
  how.at_c = {-40, 25, 25, 85, 85};
  const FleetLot lot = fleet_lot(test::made_temperature_lot(of_devices(60), how, 5).records);
  const QuantityLot& bias = *find(lot, DeviceQuantity::turn_on_bias);
  REQUIRE(bias.temperatures);
  CHECK(bias.temperatures->reference_c == 25);
  CHECK(bias.temperatures->devices == 60);
  CHECK(bias.temperatures->recordings == 300);
  CHECK(bias.temperatures->range_c.low == -40);
  // The line takes two of five recordings. Its neglect would give .1: 2e-3 a degree over 50 degrees.
  CHECK(bias.temperatures->dof == 180);
  CHECK(bias.repeats->within == Approx(how.scatter).epsilon(0.15));
  CHECK(contains(bias.figures->mean_ci95, 0.3));
  CHECK(contains(bias.figures->spread_ci95, 0.1));
  const QuantityLot& tc = *find(lot, DeviceQuantity::temperature_coefficient);
  CHECK(tc.unit == "deg/s/K");
  CHECK(tc.temperatures->slopes[0].recordings == 5);
  CHECK(tc.temperatures->slopes[0].temperature_c.high == 85);
}

TEST_CASE("two recordings a device, no temperature twice: the coefficient's error is not known, and it is not given") {
  test::MadeTemperatures how;
  how.at_c = {0, 50};
  auto records = test::made_temperature_lot(of_devices(20), how, 6).records;
  const FleetLot lot = fleet_lot(records);
  CHECK(find(lot, DeviceQuantity::temperature_coefficient) == nullptr);
  const QuantityLot& bias = *find(lot, DeviceQuantity::turn_on_bias);
  CHECK(bias.temperatures->dof == 0);
  CHECK_FALSE(bias.repeats);
  // One device that was recorded twice at one of them says how all repeat.
  auto more = test::made_temperature_lot(of_devices(3), {.at_c = {25, 25, 25}}, 7).records;
  for (DeviceRecord& r : more) r.device = "again" + r.device;
  test::append(records, more);
  const FleetLot known = fleet_lot(records);
  const QuantityLot& tc = *find(known, DeviceQuantity::temperature_coefficient);
  CHECK(tc.counts.members == 20);
  CHECK(tc.temperatures->dof == 6);
  CHECK(find(known, DeviceQuantity::turn_on_bias)->repeats->devices == 3);
}

TEST_CASE("temperatures that hardly differ have no slope, unknown ones neither") {
  test::MadeTemperatures how;
  how.at_c = {20, 29, 25};
  auto records = test::made_temperature_lot(of_devices(20), how, 8).records;
  CHECK(find(fleet_lot(records), DeviceQuantity::temperature_coefficient) == nullptr);
  CHECK_FALSE(find(fleet_lot(records), DeviceQuantity::turn_on_bias)->temperatures);
  how.at_c = {-20, 25, 60};
  records = test::made_temperature_lot(of_devices(20), how, 8).records;
  for (DeviceRecord& r : records) r.temperature_c.reset();
  CHECK_FALSE(find(fleet_lot(records), DeviceQuantity::turn_on_bias)->temperatures);
}

TEST_CASE("a lot of coefficients is of one way to find them, the one that more devices have") {
  const test::MadeTemperatures how;
  auto records = test::made_temperature_lot(of_devices(20), how, 9).records;
  for (std::size_t i = 0; i < records.size(); ++i)
    if (i < 10 * how.at_c.size())  // ten of twenty devices
      records[i].channels[0].values.push_back(found_inside(7e-3));
  const FleetLot half = fleet_lot(records);
  const QuantityLot& slopes = *find(half, DeviceQuantity::temperature_coefficient);
  CHECK(slopes.counts.counted == 20);
  CHECK(slopes.figures->mean == Approx(2e-3).epsilon(0.3));
  CHECK(slopes.temperatures->in_one_recording == 10);
  for (std::size_t i = 10 * how.at_c.size(); i < records.size(); ++i)
    records[i].channels[0].values.push_back(found_inside(7e-3));
  const FleetLot all = fleet_lot(records);
  const QuantityLot& inside = *find(all, DeviceQuantity::temperature_coefficient);
  CHECK_FALSE(inside.temperatures);
  CHECK(inside.figures->mean == Approx(7e-3));
}

TEST_CASE("two lots are compared by their slopes over temperature too") {
  test::MadeTemperatures other;
  other.slope *= 2;
  const FleetComparison c = compare_lots(test::made_temperature_lot(of_devices(30), {}, 1).records,
                                         test::made_temperature_lot(of_devices(30), other, 2).records);
  const auto tc = std::find_if(c.differences.begin(), c.differences.end(),
                               [](const auto& d) { return d.quantity == DeviceQuantity::temperature_coefficient; });
  REQUIRE(tc != c.differences.end());
  CHECK(tc->mean_differs);
  CHECK(contains(tc->change_ci95, 2e-3));
}

TEST_CASE("devices without a slope are devices of their lot too, where slopes are too few") {
  auto a = test::made_temperature_lot(of_devices(10), {}, 1).records;
  test::MadeLot others = of_devices(10);
  others.prefix = "other";
  test::append(a, test::made_lot(others, 3));
  const FleetComparison c = compare_lots(a, test::made_lot(of_devices(20), 2));
  REQUIRE(!c.not_compared.empty());
  CHECK_THAT(c.not_compared[0],
             Contains("known of 10 of 20 devices of A and of 0 of 20 devices of B: too few of B for means"));
}

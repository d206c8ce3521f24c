// Lots of which some devices are not detected: what all of them say together.

#include <catch2/catch.hpp>
#include <cmath>
#include <stdexcept>

#include "libchar/lot/fleet_lot.hpp"
#include "tests/lot/made_fleet.hpp"

using namespace libchar;

namespace {

/// Devices with a random walk about `mean`, found over as much again; small ones are not detected.
std::vector<DeviceRecord> made_walks(std::size_t devices, double mean, double spread, test::Gaussian& gauss) {
  constexpr int kDof = 20;
  test::MadeLot made;
  made.devices = devices;
  made.channels = {"gyro_x"};
  std::vector<DeviceRecord> records = test::made_lot(made, 1);
  for (DeviceRecord& r : records) {
    const double truth = std::pow(mean * std::exp(spread * gauss()), 2), beneath = mean * mean;
    const double found = (truth + beneath) * gauss.mean_square(kDof) - beneath;
    const double sd = (std::max(found, 0.0) + beneath) * std::sqrt(2.0 / kDof);
    RecordedValue value;
    value.quantity = DeviceQuantity::random_walk;
    value.in_all = SquareInAll{found, sd, 2 * std::sqrt(2.0 / kDof)};
    value.status = found > sd ? Status::detected : Status::not_detected;
    if (value.status == Status::detected) {
      value.value = std::sqrt(found);
      value.sd = sd / (2 * found);
      value.ci95 = {0.5 * value.value, 1.5 * value.value};
    } else {
      value.upper95 = std::sqrt(std::max(found, 0.0) + 2 * sd);
    }
    r.channels[0].values = {value};
  }
  return records;
}

const QuantityLot& walk_of(const FleetLot& lot) {
  for (const QuantityLot& q : lot.quantities)
    if (q.quantity == DeviceQuantity::random_walk) return q;
  throw std::runtime_error("no random walk");
}

}  // namespace

TEST_CASE("a lot's mean and spread are of all devices, also of those that are not detected") {
  test::Gaussian gauss(9);
  int mean = 0, spread = 0;
  constexpr int kLots = 60;
  for (int l = 0; l < kLots; ++l) {
    const FleetLot lot = fleet_lot(made_walks(100, 2, 0.2, gauss));
    const QuantityLot& q = walk_of(lot);
    REQUIRE(q.of_all);
    REQUIRE(q.figures);
    REQUIRE(q.arithmetic);
    CHECK(q.effects->count == 100);
    CHECK(q.counts.not_detected > 2);
    CHECK_FALSE(q.left_out);
    mean += q.figures->mean_ci95.low <= 2 && 2 <= q.figures->mean_ci95.high;
    spread += q.figures->spread_ci95.low <= 0.2 && 0.2 <= q.figures->spread_ci95.high;
    CHECK(q.arithmetic->mean >= q.figures->mean);
  }
  CHECK(mean >= 51);
  CHECK(spread >= 51);
}

TEST_CASE("where a square is not known, or few are detected, figures are of those counted or none") {
  test::Gaussian gauss(4);
  std::vector<DeviceRecord> records = made_walks(100, 2, 0.2, gauss);
  for (DeviceRecord& r : records) {
    RecordedValue& v = r.channels[0].values[0];
    if (v.status != Status::not_detected) continue;
    v.in_all = std::nullopt;
    break;
  }
  const FleetLot lot = fleet_lot(records);
  CHECK_FALSE(walk_of(lot).of_all);
  CHECK(walk_of(lot).left_out);
  for (std::size_t i = 0; i < records.size(); ++i) {
    RecordedValue& v = records[i].channels[0].values[0];
    if (i < 70) v.status = Status::not_detected;
    v.in_all = SquareInAll{4, 2, 0.5};
  }
  CHECK_FALSE(walk_of(fleet_lot(records)).figures);
}

TEST_CASE("two lots are compared by the means of all their devices") {
  test::Gaussian gauss(6);
  int alike = 0, unlike = 0;
  for (int l = 0; l < 20; ++l) {
    const auto a = made_walks(150, 2, 0.2, gauss);
    alike += compare_lots(a, made_walks(150, 2, 0.2, gauss)).differences[0].mean_differs;
    const FleetComparison c = compare_lots(a, made_walks(150, 2.6, 0.2, gauss));
    unlike += c.differences[0].mean_differs;
  }
  CHECK(alike <= 4);
  CHECK(unlike >= 18);
}

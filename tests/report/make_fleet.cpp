// make_fleet KIND FOLDER: writes the report of a synthetic fleet for the browser test (browser_test.py). KIND is a
// number of devices, or "hostile": names that want to be something else.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "libchar/core/file/whole_file.hpp"
#include "libchar/report/compare/comparison_text.hpp"
#include "libchar/report/html/fleet_report.hpp"
#include "tests/lot/made_fleet.hpp"

namespace {

using namespace libchar;

std::vector<DeviceRecord> fleet_of(std::size_t devices) {
  test::MadeLot lot;
  lot.devices = (devices + 3) / 4;
  lot.channels = {"accel_x", "accel_y", "accel_z", "gyro_x", "gyro_y", "gyro_z"};
  std::vector<DeviceRecord> records;
  for (int batch = 1; batch <= 4; ++batch) {
    lot.batch = "2024-0" + std::to_string(batch);
    lot.prefix = "imu-" + lot.batch + "-";
    if (batch == 3) lot.mean[1] *= 1.15;
    test::append(records, test::made_lot(lot, static_cast<std::uint64_t>(batch)));
  }
  for (DeviceRecord& r : records)
    for (std::size_t c = 0; c < 3; ++c) r.channels[c].unit = "m/s²";
  test::Gaussian gauss(77);
  for (std::size_t i = 0; i < records.size(); i += 97)
    records[i].channels[3].values[i % 3].value *= 1.5 + gauss.uniform();
  for (std::size_t i = 0; i < records.size(); i += 5)
    for (RecordedChannel& c : records[i].channels) {
      c.values[2].status = Status::not_detected;
      c.values[2].upper95 = 1e-3;
      c.values[2].value = kNone;
    }
  for (std::size_t i = 40; i < records.size(); i += 211) {
    records[i].problem = records[i].log + ": is empty";
    records[i].channels.clear();
    records[i].report.clear();
  }
  return records;
}

std::vector<DeviceRecord> hostile_fleet() {
  std::vector<DeviceRecord> records = fleet_of(40);
  const std::string bad = "\"><img src=x onerror=\"window.broken=1\"></script><script>window.broken=1</script>";
  for (DeviceRecord& r : records) {
    r.type = "javascript:window.broken=1" + bad;
    r.batch += bad;
    r.report = "javascript:window.broken=1//" + bad;
    r.log = bad;
    for (RecordedChannel& c : r.channels) c.name += bad;
  }
  records[1].device = bad;
  records[2].device = "\xff\xfe \u202e \u2028";
  records[3].problem = bad;
  records[5].channels[1].values[0].value *= 3;
  records[5].report = "//example.org/x";
  return records;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const std::string kind = argv[1], folder = argv[2];
  try {
    const auto records = kind == "hostile" ? hostile_fleet() : fleet_of(std::stoul(kind));
    FleetLotOptions options;
    if (kind != "hostile")
      options.limits["mems"] = parse_limits(
          "format: noise-limits\nversion: 1\nlimits:\n  - kind: angular_rate\n    bias_instability: {value: 3.5e-3, "
          "unit: deg/s}\n    white_noise: {value: 20.5, unit: deg/√h}\n",
          "limits.yaml");
    const FleetLot lot = fleet_lot(records, options);
    write_fleet_report({records, &lot, "made of numbers", {"make_fleet", kind}, {}}, folder, true);
    write_whole_file(folder + "/record.json", device_record_text(records[0]), true);
    const auto half = static_cast<std::ptrdiff_t>(records.size() / 2);
    const std::vector<DeviceRecord> first(records.begin(), records.begin() + half),
        second(records.begin() + half, records.end());
    write_whole_file(folder + "/comparison.json", dump_json(fleet_comparison_json(compare_lots(first, second))), true);
    write_whole_file(folder + "/lot.txt", fleet_text({records, &lot, "", {}, {}}), true);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_fleet: %s\n", error.what());
    return 1;
  }
}

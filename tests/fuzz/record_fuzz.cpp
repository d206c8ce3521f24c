// Any bytes as device records, one a line: the fast way to read one and the way by a document agree, what is read is
// written and read back, and the lot of such devices is computed and reported, whatever their numbers are.

#include <nlohmann/json.hpp>

#include "libchar/lot/detail/record_scanner.hpp"
#include "libchar/lot/fleet_lot.hpp"
#include "libchar/report/html/fleet_report.hpp"
#include "tests/fuzz/fuzz_support.hpp"

using namespace libchar;

namespace {

std::string text_or_refusal(std::string_view line) {
  try {
    return device_record_text(read_device_record(line, "r"));
  } catch (const Error& error) {
    return fuzz::said(error);
  }
}

/// Devices that differ a little from one that was read: a lot needs several.
std::vector<DeviceRecord> alike(const DeviceRecord& record, std::uint8_t choice) {
  std::vector<DeviceRecord> out;
  for (int k = 0; k < 1 + choice % 8; ++k) {
    DeviceRecord one = record;
    if (choice % 16 < 8) one.device += std::to_string(k);
    if (choice % 32 < 16) one.batch += std::to_string(k / 4);
    one.sha256 += std::to_string(k);
    for (RecordedChannel& channel : one.channels)
      for (RecordedValue& value : channel.values) value.value *= 1 + 0.01 * k;
    out.push_back(std::move(one));
  }
  return out;
}

void report(const std::vector<DeviceRecord>& records) {
  FleetLotOptions options;
  if (records.size() % 2 == 1)
    options.limits[""] = parse_limits(
        "format: noise-limits\nversion: 1\nlimits:\n  - {kind: angular_rate, white_noise: {value: 2, unit: deg/√h}, "
        "bias_instability: {value: 5, unit: deg/h}}\n",
        "l.yaml");
  try {
    const FleetLot lot = fleet_lot(records, options);
    FleetReport said;
    said.records = records;
    said.lot = &lot;
    fleet_json(said).dump();
    fleet_text(said);
    fleet_html(said);
  } catch (const Error& error) {
    fuzz::said(error);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  std::vector<DeviceRecord> records;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::string slow = text_or_refusal(line);
    if (const auto scanned = scan_device_record(line))
      fuzz::expect_same("scanned, and read as a document", device_record_text(*scanned), slow);
    try {
      const DeviceRecord record = parse_device_record(line, "r");
      fuzz::expect_same("a record, written and read", slow, text_or_refusal(slow));
      for (DeviceRecord& one : alike(record, data[0])) records.push_back(std::move(one));
    } catch (const Error& error) {
      fuzz::said(error);
    }
  }
  if (!records.empty()) report(records);
  return 0;
}

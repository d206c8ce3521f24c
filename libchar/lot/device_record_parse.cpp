// A record of any document, with what is wrong in it by line and key; lines as the program writes them are scanned.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "libchar/core/json_reader.hpp"
#include "libchar/core/schema.hpp"
#include "libchar/lot/detail/record_scanner.hpp"
#include "libchar/lot/device_record.hpp"

namespace libchar {
namespace {

// A record grows keys from version to version of the program: those we do not know are left alone.
MapReader open_level(const Document& node, const std::string& file, std::string path) {
  std::vector<std::string> keys;
  keys.reserve(node.map.size());
  for (const DocumentEntry& entry : node.map) keys.push_back(entry.key);
  return {node, file, std::move(path), std::move(keys)};
}

double end_of(const MapReader& map, const std::vector<Document>& ends, std::size_t k) {
  if (ends[k].kind == Document::Kind::null)
    return k == 0 ? kNone : std::numeric_limits<double>::infinity();
  if (ends[k].kind != Document::Kind::number) map.refuse("ci95", "an end is no number");
  return ends[k].number;
}

RecordedValue read_value(const MapReader& map, DeviceQuantity quantity) {
  RecordedValue out;
  out.quantity = quantity;
  out.status = *find_enum<Status>(map.word("status", words_of<Status>()));
  out.value = map.number_or("value", kNone, in_logarithm(quantity) ? kNotNegative : kAnyNumber);
  out.upper95 = map.number_or("upper95", kNone, kNotNegative);
  out.sd = map.number_or("sd", kNone, kNotNegative);
  if (map.has("square_in_all")) {
    const std::vector<double> of = map.numbers("square_in_all");
    if (of.size() != 3 || !(of[1] > 0))
      map.refuse("square_in_all", "expected a square, its standard deviation and its skewness");
    out.in_all = SquareInAll{of[0], of[1], of[2]};
  }
  if (!map.has("ci95")) return out;
  const std::vector<Document>& ends = map.list("ci95");
  if (ends.size() != 2) map.refuse("ci95", "expected a list of two numbers");
  out.ci95 = {end_of(map, ends, 0), end_of(map, ends, 1)};
  return out;
}

std::vector<RecordedValue> read_values(const MapReader& map) {
  std::vector<RecordedValue> out;
  for (const DocumentEntry& entry : map.node().map)
    if (const auto quantity = find_enum<DeviceQuantity>(entry.key))
      out.push_back(
          read_value(open_level(entry.value, map.file(), map.path_of(entry.key)), *quantity));
  std::sort(out.begin(), out.end(), [](const RecordedValue& a, const RecordedValue& b) {
    return a.quantity < b.quantity;
  });
  return out;
}

RecordedChannel read_record_channel(const MapReader& map) {
  RecordedChannel out;
  out.name = map.text("name");
  out.unit = map.text_or("unit", "");
  out.samples = map.count_or("samples", 0);
  out.missing = map.count_or("missing", 0);
  out.mean = map.number_or("mean", kNone);
  out.fitted = map.has("values");
  if (map.has("problems")) out.problems = map.texts("problems");
  if (!out.fitted) return out;
  out.rate_hz = map.number("rate_hz", kPositive);
  out.duration_s = map.number("duration_s", kPositive);
  out.p = map.number_or("p", kNone);
  out.values = read_values(open_level(map.require("values"), map.file(), map.path_of("values")));
  return out;
}

}  // namespace

DeviceRecord parse_device_record(std::string_view text, const std::string& path) {
  if (auto scanned = scan_device_record(text)) return *std::move(scanned);
  return read_device_record(text, path);
}

DeviceRecord read_device_record(std::string_view text, const std::string& path) {
  const Document document = parse_json_document(text, path);
  check_format(document, path, "device-record", 1);
  const MapReader map = open_level(document, path, "");
  DeviceRecord out;
  out.device = map.text("device");
  out.type = map.text_or("type", "");
  out.batch = map.text_or("batch", "");
  out.log = map.text_or("log", "");
  out.sha256 = map.text_or("sha256", "");
  out.settings = map.text_or("settings", "");
  out.program = map.text_or("program", "");
  out.temperature_c = map.maybe_number("temperature_c");
  out.report = map.text_or("report", "");
  out.limits = map.text_or("limits", "");
  out.problem = map.text_or("problem", "");
  if (map.has("warnings")) out.warnings = map.texts("warnings");
  const std::vector<Document>& channels = map.list("channels");
  out.channels.reserve(channels.size());
  for (std::size_t i = 0; i < channels.size(); ++i) {
    out.channels.push_back(
        read_record_channel(open_level(channels[i], path, fmt::format("channels[{}]", i))));
    for (std::size_t k = 0; k < i; ++k)
      if (out.channels[k].name == out.channels[i].name)
        map.refuse("channels", "two channels have one name: " + out.channels[i].name);
  }
  return out;
}

}  // namespace libchar

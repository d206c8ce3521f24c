// Any bytes as a manifest, by the first byte YAML, JSON or a table: every device has a name, a log
// by its whole path and options, and a manifest that says the same in JSON has the same devices.

#include <cmath>

#include "libchar/fleet/manifest.hpp"
#include "tests/fuzz/fleet_support.hpp"
#include "tests/fuzz/fuzz_support.hpp"

using namespace libchar;

namespace {

std::string line_of(const FleetDevice& one) {
  std::string out;
  for (const std::string* text : {&one.device, &one.log, &one.type, &one.batch, &one.limits}) out += *text + "|";
  return out + (one.temperature_c ? fuzz::bits(*one.temperature_c) : "") + "\n";
}

std::string lines_of(const Manifest& manifest) {
  std::string out;
  for (const FleetDevice& one : manifest.devices) out += line_of(one);
  return out;
}

std::string in_json(const Manifest& manifest) {
  Json out = {{"format", "fleet-manifest"}, {"version", 1}, {"devices", Json::array()}};
  for (const FleetDevice& one : manifest.devices) {
    Json entry = {{"device", one.device}, {"log", one.log}, {"type", one.type}};
    entry["batch"] = one.batch;
    if (!one.limits.empty()) entry["limits"] = one.limits;
    if (one.temperature_c) entry["temperature_c"] = *one.temperature_c;
    out["devices"].push_back(std::move(entry));
  }
  return out.dump();
}

void check(const Manifest& manifest) {
  fuzz::expect(!manifest.devices.empty(), "a manifest of nothing");
  for (const FleetDevice& one : manifest.devices) {
    fuzz::expect(!one.device.empty(), "a device without a name");
    fuzz::expect(!one.log.empty() && one.log[0] == '/', "a log without its whole path");
    fuzz::expect(one.options < manifest.options.size(), "a device without options");
    fuzz::expect(!one.temperature_c || std::isfinite(*one.temperature_c), "a temperature");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  const char* const paths[] = {"/m/f.yaml", "/m/f.json", "/m/f.csv"};
  std::string there, again;
  try {
    const Manifest manifest = parse_manifest(text, paths[data[0] % 3]);
    check(manifest);
    there = lines_of(manifest);
    again = in_json(manifest);
  } catch (const Error& error) {
    fuzz::said(error);
    return 0;
  }
  try {
    again = lines_of(parse_manifest(again, "/m/f.json"));
  } catch (const Error& error) {
    again = error.what();
  }
  fuzz::expect_same("a manifest, and the same in JSON", there, again);
  return 0;
}

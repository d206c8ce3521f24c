// A signal in a scene file or behind --truth: {kind: sine, amplitude: 2, frequency_hz: 0.1}.

#include <fmt/format.h>

#include <algorithm>

#include "libchar/core/error.hpp"
#include "libchar/core/schema.hpp"
#include "libchar/core/text.hpp"
#include "libchar/replay/scene.hpp"

namespace libchar {
namespace {

std::vector<std::string> every_key() {
  std::vector<std::string> keys = {"kind", "name", "offset"};
  for (const std::string& kind : signal_kinds())
    for (const std::string& key : signal_keys(kind))
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
  return keys;
}

void check_keys(const MapReader& at, const std::string& kind) {
  const std::vector<std::string>& own = signal_keys(kind);
  for (const DocumentEntry& entry : at.node().map) {
    const bool common = entry.key == "kind" || entry.key == "name" || entry.key == "offset";
    if (common || std::find(own.begin(), own.end(), entry.key) != own.end()) continue;
    at.refuse(entry.key,
              fmt::format("a signal of kind {} has no such key", kind),
              own.empty() ? "it has none" : fmt::format("it has {}", fmt::join(own, ", ")));
  }
}

std::vector<std::pair<double, double>> points_of(const MapReader& at) {
  std::vector<std::pair<double, double>> points;
  for (const Document& node : at.list("points")) {
    const bool pair = node.kind == Document::Kind::list && node.list.size() == 2 &&
                      node.list[0].kind == Document::Kind::number &&
                      node.list[1].kind == Document::Kind::number;
    if (!pair) at.refuse("points", "expected a list of [seconds, value]");
    if (!points.empty() && node.list[0].number <= points.back().first)
      at.refuse("points", "the times must rise");
    points.emplace_back(node.list[0].number, node.list[1].number);
  }
  if (points.empty()) at.refuse("points", "expected at least one [seconds, value]");
  return points;
}

}  // namespace

SignalSpec read_signal(const Document& node, const std::string& file, const std::string& path) {
  const MapReader at(node, file, path, every_key());
  SignalSpec spec;
  spec.kind = at.word("kind", signal_kinds());
  check_keys(at, spec.kind);
  spec.offset = at.number_or("offset", 0);
  spec.value = at.number_or("value", 0);
  spec.amplitude = at.number_or("amplitude", spec.amplitude);
  spec.frequency_hz = at.number_or("frequency_hz", spec.frequency_hz, kNotNegative);
  spec.phase_rad = at.number_or("phase_rad", 0);
  spec.from_hz = at.number_or("from_hz", spec.from_hz, kNotNegative);
  spec.to_hz = at.number_or("to_hz", spec.to_hz, kNotNegative);
  spec.standard_deviation = at.number_or("standard_deviation", 1, kNotNegative);
  spec.bandwidth_hz = at.number_or("bandwidth_hz", 0, kNotNegative);
  spec.renew_s = at.number_or("renew_s", 0, kNotNegative);
  spec.repeat = at.number_or("repeat", 0, {0, 1, false});
  spec.step = at.number_or("step", 1, kNotNegative);
  spec.slope = at.number_or("slope", 0);
  if (at.has("points")) spec.points = points_of(at);
  if (spec.kind == "points" && spec.points.empty()) at.require("points");
  if (at.has("of")) spec.of = static_cast<std::size_t>(at.count("of"));
  if (spec.kind == "recording") {
    spec.file = at.text("file");
    spec.channel = at.text_or("channel", "");
  }
  return spec;
}

}  // namespace libchar

#include "libchar/scene/detail/scene_values.hpp"

#include <fmt/format.h>

#include <cmath>

#include "libchar/core/text/decimal.hpp"

namespace libchar {

Entry word_entry(std::string_view key, std::string word) {
  Entry entry{std::string(key), std::move(word)};
  entry.bare = true;
  return entry;
}

std::optional<TimeWindow> window_of(const MapReader& at, std::string_view key) {
  if (!at.has(key)) return std::nullopt;
  const auto& ends = at.list(key);
  TimeWindow window;
  const auto number = [&](const Document& node) {
    if (node.kind != Document::Kind::number)
      throw scene_refusal_at("E0740", at, node, std::string(key)).says("expected a number");
    return node.number;
  };
  if (ends.size() != 2) throw scene_refusal("E0740", at, key).says("expected [from, to] in seconds, or [from, end]");
  window.from_s = number(ends[0]);
  if (ends[1].text != "end") window.to_s = number(ends[1]);
  if (window.from_s < 0 || !(window.from_s < window.to_s))
    throw scene_refusal("E0740", at, key).says("expected 0 <= from < to");
  return window;
}

void write_window(std::string_view key, const std::optional<TimeWindow>& window, std::vector<Entry>& out) {
  if (!window) return;
  if (std::isfinite(window->to_s))
    out.push_back({std::string(key), std::vector<double>{window->from_s, window->to_s}});
  else
    out.push_back(word_entry(key, "[" + shortest_yaml(window->from_s) + ", end]"));
}

OrEstimate number_or_estimate(const MapReader& at, std::string_view key, const std::string& expected) {
  const Document& node = at.require(key);
  const bool estimate = node.kind == Document::Kind::text && node.text == "estimate";
  if (node.kind == Document::Kind::text && !estimate) at.refuse(key, fmt::format("expected {}, or estimate", expected));
  return {estimate ? 0 : at.number(key), estimate};
}

void write_or_estimate(std::string_view key, const OrEstimate& said, std::vector<Entry>& out) {
  if (said.estimate)
    out.push_back(word_entry(key, "estimate"));
  else if (said.value != 0)
    out.push_back({std::string(key), said.value});
}

}  // namespace libchar

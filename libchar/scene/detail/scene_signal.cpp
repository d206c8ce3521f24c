// A signal in a scene file or behind --truth: {kind: sine, amplitude: 2, frequency_hz: 0.1}.

#include "libchar/scene/detail/scene_signal.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libchar/core/error.hpp"
#include "libchar/scene/detail/scene_fields.hpp"
#include "libchar/scene/detail/scene_parts.hpp"

namespace libchar {
namespace {

bool holds(const std::vector<std::string>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

const std::vector<std::string> kCommon = {"kind", "name", "offset"};

std::vector<std::string> keys_of(const std::string& kind) {
  std::vector<std::string> keys = kCommon;
  if (kind == "zero") keys.pop_back();  // zero is zero
  for (const std::string& key : signal_keys(kind)) keys.push_back(key);
  return keys;
}

// A key that other kinds read is named as such; unknown ones are left to MapReader.
void refuse_keys_of_other_kinds(const Document& node,
                                const MapReader& at,
                                const std::string& kind) {
  for (const DocumentEntry& entry : node.map) {
    if (holds(keys_of(kind), entry.key)) continue;
    std::vector<std::string> others;
    for (const std::string& other : signal_kinds())
      if (holds(keys_of(other), entry.key)) others.push_back(other);
    if (others.empty()) continue;
    Document place;
    place.line = entry.line;
    place.column = entry.column;
    const std::vector<std::string>& own = signal_keys(kind);
    throw Error(
        {ErrorKind::input,
         "E0739",
         at.where(place),
         fmt::format("{}: is a key of {}, and this signal is of kind {}",
                     at.path_of(entry.key),
                     others.size() > 5 ? "other kinds" : fmt::format("{}", fmt::join(others, ", ")),
                     kind),
         entry.key,
         own.empty() ? fmt::format("{} needs no further key", kind)
                     : fmt::format("{} reads {}", kind, fmt::join(own, ", "))});
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
  if (points.empty()) refuse_scene("E0736", at, "points", "expected at least one [seconds, value]");
  return points;
}

// Index or name of a signal that stands before this one.
std::size_t earlier_signal(const MapReader& at, const std::vector<std::string>& earlier) {
  const Document& node = at.require("of");
  const bool index = node.kind == Document::Kind::number;
  if (index) {
    const std::uint64_t of = at.count("of");
    if (of < earlier.size()) return static_cast<std::size_t>(of);
  }
  if (earlier.empty())
    refuse_scene("E0738", at, "of", "is to name a signal before this one, and there is none");
  return index_of_name(at, "of", at.text("of"), earlier, "a signal that stands before this one");
}

}  // namespace

SignalSpec read_signal(const Document& node,
                       const std::string& file,
                       const std::string& path,
                       const std::vector<std::string>& earlier) {
  SignalSpec spec;
  if (node.kind == Document::Kind::number) {
    spec.kind = "constant";
    spec.value = node.number;
    return spec;
  }
  if (node.kind == Document::Kind::text) {  // read as {kind: WORD}
    Document map;
    map.kind = Document::Kind::map;
    map.line = node.line;
    map.column = node.column;
    map.map.push_back({"kind", node.line, node.column, node});
    return read_signal(map, file, path, earlier);
  }
  std::vector<std::string> every;
  if (node.kind == Document::Kind::map)
    for (const DocumentEntry& entry : node.map) every.push_back(entry.key);
  const MapReader any(node, file, path, every);
  spec.kind = any.word("kind", signal_kinds());
  refuse_keys_of_other_kinds(node, any, spec.kind);
  const MapReader at(node, file, path, keys_of(spec.kind));
  read_fields(signal_fields(), at, spec);
  const std::vector<std::string>& own = signal_keys(spec.kind);
  // These say what the signal is: without them it would be zero, unnoticed.
  for (const char* key : {"value", "slope"})
    if (holds(own, key)) at.require(key);
  if (holds(own, "points")) spec.points = points_of(at);
  if (holds(own, "of")) spec.of = earlier_signal(at, earlier);
  if (spec.kind == "recording") {
    spec.file = at.text("file");
    spec.channel = at.text_or("channel", "");
  }
  return spec;
}

}  // namespace libchar

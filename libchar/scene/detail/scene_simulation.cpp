// The blocks `recording` and `simulate` of a scene file.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/scene/detail/scene_fields.hpp"
#include "libchar/scene/detail/scene_values.hpp"

namespace libchar {

// A signal in a scene file or behind --truth: {kind: sine, amplitude: 2, frequency_hz: 0.1}.

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
void refuse_keys_of_other_kinds(const Document& node, const MapReader& at, const std::string& kind) {
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
    throw input_error("E0739", at.where(place))
        .says("{}: is a key of {}, and this signal is of kind {}", at.path_of(entry.key),
              others.size() > 5 ? "other kinds" : fmt::format("{}", fmt::join(others, ", ")), kind)
        .got(entry.key)
        .hint(own.empty() ? fmt::format("{} needs no further key", kind)
                          : fmt::format("{} reads {}", kind, fmt::join(own, ", ")));
  }
}

std::vector<std::pair<double, double>> points_of(const MapReader& at) {
  std::vector<std::pair<double, double>> points;
  for (const Document& node : at.list("points")) {
    const bool pair = node.kind == Document::Kind::list && node.list.size() == 2 &&
                      node.list[0].kind == Document::Kind::number && node.list[1].kind == Document::Kind::number;
    if (!pair) at.refuse("points", "expected a list of [seconds, value]");
    if (!points.empty() && node.list[0].number <= points.back().first) at.refuse("points", "the times must rise");
    points.emplace_back(node.list[0].number, node.list[1].number);
  }
  if (points.empty()) throw scene_refusal("E0736", at, "points").says("expected at least one [seconds, value]");
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
    throw scene_refusal("E0738", at, "of").says("is to name a signal before this one, and there is none");
  return index_of_name(at, "of", at.text("of"), earlier, "a signal before this one");
}

}  // namespace

SignalSpec read_signal(const Document& node, const std::string& file, const std::string& path,
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

namespace {

constexpr std::uint64_t kMostSamples = 1'000'000'000'000'000;  // every index exact in a double

std::uint64_t samples_of(const MapReader& at, double rate_hz) {
  if (at.has("samples") == at.has("duration_s"))
    throw scene_refusal("E0735", at, at.has("samples") ? "samples" : "duration_s")
        .says("a simulation has either duration_s or samples");
  const char* key = at.has("samples") ? "samples" : "duration_s";
  const double samples =
      at.has("samples") ? static_cast<double>(at.count(key)) : std::round(at.number(key, kPositive) * rate_hz);
  if (samples < 1) at.refuse(key, "there is no sample to simulate");
  if (samples > static_cast<double>(kMostSamples)) at.refuse(key, fmt::format("more than {} samples", kMostSamples));
  return static_cast<std::uint64_t>(samples);
}

// Reads the samples of a signal that comes from a log.
void read_samples(SignalSpec& spec, const MapReader& at, const ArraySimulation& simulation, const SceneFolder& folder,
                  Scene& scene) {
  ReadOptions reading;
  reading.hash = false;
  if (!spec.channel.empty()) reading.channels = {spec.channel};
  spec.file = scene_file_of(at, "file", folder, scene);
  Recording log = read_recording(spec.file, reading);
  if (log.samples.size() != 1)
    throw scene_refusal("E0742", at, "file")
        .says("holds {} channels", log.samples.size())
        .hint("name one: channel: NAME");
  const double rate = log.info.time.rate_hz;
  if (rate > 0 && std::abs(rate / simulation.rate_hz - 1) > 1e-4)
    throw scene_refusal("E0742", at, "file")
        .says("is a recording at {}, and the simulation runs at {}", detail::frequency_text(rate, 6),
              detail::frequency_text(simulation.rate_hz, 6))
        .hint("give the simulation the rate of the recording");
  spec.samples = std::move(log.samples[0]);
  if (spec.samples.empty()) throw scene_refusal("E0742", at, "file").says("holds no sample");
  if (spec.samples.size() < simulation.samples)
    scene.warnings.add("recorded_signal_short", "a recorded signal ends before the simulation; its last sample is held",
                       at.where(at.require("file")));
}

SignalSpec signal_of(const Document& node, const std::string& path, const ArraySimulation& simulation,
                     const std::vector<std::string>& earlier, const SceneFolder& folder, Scene& scene) {
  SignalSpec spec = read_signal(node, folder.scene, path, earlier);
  if (spec.kind == "recording") {
    const MapReader at(node, folder.scene, path, {"kind", "name", "offset", "file", "channel"});
    read_samples(spec, at, simulation, folder, scene);
  }
  return spec;
}

void add_truth(const MapReader& at, const Document& node, const std::string& path, const std::string& usual_name,
               ArraySimulation& s, const SceneFolder& folder, Scene& scene) {
  SignalSpec spec = signal_of(node, path, s, s.truth_names, folder, scene);
  const DocumentEntry* named = node.find("name");
  std::string name = named == nullptr ? usual_name : named->value.text;
  const Document& place = named == nullptr ? node : named->value;
  if (name.empty() || name.find('\0') != std::string::npos)
    throw input_error("E0737", at.where(place))
        .says("{}.name: the name of a signal is empty or holds a zero byte", path);
  if (std::find(s.truth_names.begin(), s.truth_names.end(), name) != s.truth_names.end())
    throw input_error("E0737", at.where(place)).says("{}.name: two truth signals have one name", path).got(name);
  s.truth.push_back(std::move(spec));
  s.truth_names.push_back(std::move(name));
}

void read_truth(const MapReader& at, ArraySimulation& s, const SceneFolder& folder, Scene& scene) {
  const Document& node = at.require("truth");
  const std::string path = at.path_of("truth");
  s.truth.clear();
  s.truth_names.clear();
  if (node.kind != Document::Kind::list) return add_truth(at, node, path, "truth", s, folder, scene);
  if (node.list.empty()) throw scene_refusal("E0736", at, "truth").says("expected at least one signal");
  for (std::size_t j = 0; j < node.list.size(); ++j)
    add_truth(at, node.list[j], fmt::format("{}[{}]", path, j),
              node.list.size() == 1 ? "truth" : fmt::format("truth{}", j + 1), s, folder, scene);
}

}  // namespace

std::string scene_file_of(const MapReader& at, std::string_view key, const SceneFolder& folder, Scene& scene,
                          SceneFolder::Kind folders) {
  std::string path = resolve_scene_file(at.text(key), folder, at.where(at.require(key)), at.path_of(key), folders);
  if (std::find(scene.files.begin(), scene.files.end(), path) == scene.files.end()) scene.files.push_back(path);
  return path;
}

std::string scene_recording_of(const MapReader& at, std::string_view key, const SceneFolder& folder,
                               ReadOptions& reading, Scene& scene) {
  if (is_scalar(at.require(key))) return scene_file_of(at, key, folder, scene, SceneFolder::Kind::logs);
  std::vector<std::string> keys = keys_of(scene_reading_fields());
  keys.insert(keys.begin(), {"file", "resample_hz"});
  const MapReader map = at.map(key, keys);
  read_fields(scene_reading_fields(), map, reading);
  if (std::string& msg = reading.unsaid.msg; !msg.empty())
    msg = resolve_scene_file(msg, folder, map.where(map.require("msg")), map.path_of("msg"), SceneFolder::Kind::any);
  const auto resample_hz = map.maybe_number("resample_hz", kPositive);
  if (resample_hz && (&reading != &scene.reading || reading.rate_hz))
    map.refuse("resample_hz", reading.rate_hz ? "rate_hz is for logs without stamps, resample_hz for uneven ones"
                                              : "a reference is interpolated in any case");
  if (resample_hz) scene.resample_hz = resample_hz;
  const std::vector<std::string> words = {"auto", "tab", "space"};
  if (reading.delimiter.size() != 1 && std::find(words.begin(), words.end(), reading.delimiter) == words.end())
    map.refuse("delimiter", "expected auto, tab, space or one character");
  if (reading.from_s && reading.to_s && !(*reading.from_s < *reading.to_s))
    throw scene_refusal("E0740", map, "to_s").says("the recording is read from a time to a later one");
  return scene_file_of(map, "file", folder, scene, SceneFolder::Kind::logs);
}

ArraySimulation scene_simulation_of(const MapReader& top, const SceneFolder& folder, Scene& scene) {
  const MapReader at = top.map("simulate", keys_of(simulation_fields()));
  ArraySimulation s;
  read_fields(simulation_fields(), at, s);
  s.samples = samples_of(at, s.rate_hz);
  check_oversampling(at, s.oversampling);
  if (at.has("truth")) read_truth(at, s, folder, scene);
  if (at.has("temperature"))
    s.temperature = signal_of(at.require("temperature"), at.path_of("temperature"), s, s.truth_names, folder, scene);
  return s;
}

}  // namespace libchar

#include "libchar/scene/scene_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "libchar/core/document/document.hpp"
#include "libchar/core/document/document_file.hpp"
#include "libchar/core/document/fields.hpp"
#include "libchar/core/document/json_reader.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/read.hpp"
#include "libchar/scene/detail/scene_fields.hpp"
#include "libchar/scene/detail/scene_parts.hpp"
#include "libchar/scene/detail/scene_sensors.hpp"
#include "libchar/scene/detail/scene_simulation.hpp"
#include "libchar/scene/detail/scene_times.hpp"

namespace libchar {
namespace {

// The blocks `reference` and `tilt` of a scene file.
// The blocks `reference` and `tilt` of a scene file, and the rows h that they go with.

void read_options(const MapReader& at,
                  const SceneFolder& folder,
                  SceneReference& reference,
                  Scene& scene) {
  for (const std::string& key : keys_of(reference_fields()))
    if (scene.simulate && key != "channels" && at.has(key))
      at.refuse(key, "a simulation knows its truth: name truth signals only");
  if (at.has("lag_s") && at.has("delay"))
    refuse_scene("E0735", at, "delay", "lag_s says the same", "give one of them");
  read_fields(reference_fields(), at, reference);
  if (at.has("recording"))
    reference.recording = scene_recording_of(at, "recording", folder, reference.reading, scene);
}

void read_reference(const MapReader& top, const SceneFolder& folder, Scene& scene) {
  if (!top.has("reference")) {
    // What was simulated is known.
    if (scene.simulate) scene.reference.emplace().channels = scene.simulate->truth_names;
    return;
  }
  SceneReference reference;
  const Document& node = top.require("reference");
  std::optional<MapReader> map;
  if (node.kind == Document::Kind::map) map = top.map("reference", keys_of(reference_fields()));
  const MapReader& at = map ? *map : top;
  const char* key = map ? "channels" : "reference";
  reference.channels = at.texts(key);
  if (reference.channels.empty()) refuse_scene("E0736", at, key, "expected the name of a channel");
  const Document& names = at.require(key);
  for (const Document& name : is_scalar(names) ? std::vector<Document>{names} : names.list)
    check_scene_text(top, name, at.path_of(key), scene);
  if (std::set<std::string>(reference.channels.begin(), reference.channels.end()).size() !=
      reference.channels.size())
    refuse_scene("E0737", at, key, "a channel stands twice");
  if (map) read_options(at, folder, reference, scene);
  if (scene.simulate)
    for (const std::string& channel : reference.channels)
      index_of_name(at, key, channel, scene.simulate->truth_names, "a truth signal");
  scene.reference = std::move(reference);
}

void read_tilt(const MapReader& top, const SensorIndex& index, Scene& scene) {
  const MapReader at = top.map("tilt", keys_of(tilt_fields()));
  const auto sensor = [&](const char* key) { return sensor_index(at, key, scene, index); };
  const SceneTilt tilt{sensor("gyroscope"), sensor("accelerometer_x"), sensor("accelerometer_z")};
  if (tilt.gyroscope == tilt.accelerometer_x || tilt.gyroscope == tilt.accelerometer_z ||
      tilt.accelerometer_x == tilt.accelerometer_z)
    refuse_scene("E0747", top, "tilt", "three different sensors make a tilt");
  if (scene.reference && !scene.reference->mean && scene.reference->channels.size() != 1)
    refuse_scene("E0747",
                 top,
                 "reference",
                 "the reference of a tilt is one channel: the angle",
                 "reference: [NAME]");
  scene.tilt = tilt;
}

// Every sensor weighs the same true inputs.
void check_rows(const MapReader& top, const SensorIndex& index, const Scene& scene) {
  if (scene.tilt && !scene.simulate) return;
  std::size_t inputs = scene.sensors[0].h.size();
  if (scene.simulate)
    inputs = scene.simulate->truth.size();
  else if (scene.reference)
    inputs = scene.reference->mean ? 1 : scene.reference->channels.size();
  for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
    const std::vector<double>& h = scene.sensors[i].h;
    const std::string name = printable(scene.sensors[i].name, 40);
    if (h.size() != inputs)
      refuse_scene_value("E0741",
                         top,
                         *index.places[i].node,
                         index.places[i].path,
                         fmt::format("the row h of sensor {} has {}, and there {} {}",
                                     name,
                                     plural(h.size(), "weight"),
                                     inputs == 1 ? "is" : "are",
                                     plural(inputs, "true input")),
                         "give h one weight a truth signal or reference channel");
    const bool blind = std::all_of(h.begin(), h.end(), [](double w) { return w == 0; });
    if (blind && !scene.simulate)
      refuse_scene_value("E0741",
                         top,
                         *index.places[i].node,
                         index.places[i].path,
                         fmt::format("sensor {} sees no input: its row h is zero", name));
  }
}

// The blocks `reference` and `tilt`, and whether every row h fits the true inputs.
void read_scene_reference(const MapReader& top,
                          const SceneFolder& folder,
                          const SensorIndex& index,
                          Scene& scene) {
  read_reference(top, folder, scene);
  if (top.has("tilt")) read_tilt(top, index, scene);
  check_rows(top, index, scene);
}

class SceneReader {
 public:
  SceneReader(const Document& document, const std::string& path, const SceneReadOptions& options)
      : top_(document, path, "", keys_of(scene_fields())),
        folder_{path, options.allow_outside},
        again_(options.again) {}

  Scene read() {
    scene_.file = folder_.scene;
    scene_.name = top_.text_or("name", "");
    if (top_.has("name")) check_scene_text(top_, top_.require("name"), "name", scene_);
    read_tool(top_, "tool");
    samples();
    const SensorIndex index = read_scene_sensors(top_, folder_, scene_);
    read_scene_reference(top_, folder_, index, scene_);
    read_scene_times(top_, folder_for_again(), index, scene_);
    if (top_.has("algorithms")) algorithms();
    finish_simulation();
    return std::move(scene_);
  }

 private:
  void samples() {
    if (top_.has("recording") == top_.has("simulate"))
      refuse_scene("E0735",
                   top_,
                   top_.has("recording") ? "simulate" : "recording",
                   "a scene has either a recording or a simulation",
                   "recording: FILE, or simulate: {rate_hz, duration_s, truth}");
    if (top_.has("recording"))
      scene_.recording =
          scene_recording_of(top_, "recording", folder_for_again(), scene_.reading, scene_);
    if (top_.has("simulate")) scene_.simulate = scene_simulation_of(top_, folder_, scene_);
  }

  // A log that is made again may be gone.
  SceneFolder folder_for_again() const {
    SceneFolder folder = folder_;
    folder.may_be_absent = again_;
    return folder;
  }

  void algorithms() {
    const auto& list = top_.list("algorithms");
    if (list.empty())
      refuse_scene("E0736",
                   top_,
                   "algorithms",
                   "expected at least one algorithm",
                   "leave the key out to run every algorithm that the scene has the data for");
    for (std::size_t i = 0; i < list.size(); ++i)
      scene_.algorithms.push_back(algorithm(list[i], fmt::format("algorithms[{}]", i)));
  }

  // Names and options are checked by the planner, which knows the table.
  SceneAlgorithm algorithm(const Document& node, const std::string& path) {
    SceneAlgorithm algorithm;
    algorithm.line = node.line;
    algorithm.column = node.column;
    const DocumentEntry* named = node.find("name");
    const Document& name = named != nullptr ? named->value : node;
    if (!is_scalar(name) || name.kind == Document::Kind::null || name.text.empty())
      refuse_scene_value(
          "E0737", top_, name, path, "an algorithm has a name", "{name: minque, gamma: 0.999}");
    check_scene_text(top_, name, path, scene_);
    algorithm.name = name.text;
    for (const DocumentEntry& entry : node.map) {
      if (entry.key == "name") continue;
      const std::string key = fmt::format("{}.{}", path, printable(entry.key, 40));
      if (entry.value.kind != Document::Kind::number)
        refuse_scene_value(
            "E0744", top_, entry.value, key, "an option of an algorithm is a number");
      algorithm.options.emplace_back(entry.key, entry.value.number);
    }
    return algorithm;
  }

  void finish_simulation() {
    if (!scene_.simulate) return;
    for (const SceneSensor& sensor : scene_.sensors)
      scene_.simulate->sensors.push_back(
          {sensor.name, sensor.model.value_or(SensorModel{}), sensor.h});
    scene_.simulate->faults = scene_.faults;
    try {
      check(*scene_.simulate);
    } catch (const Error& error) {
      Problem problem = error.problem();
      problem.where = top_.where(top_.require("simulate"));
      throw Error(problem);
    }
  }

  MapReader top_;
  SceneFolder folder_;
  bool again_;
  Scene scene_;
};

}  // namespace

void refuse_scene(const char* code,
                  const MapReader& at,
                  std::string_view key,
                  const std::string& what,
                  const std::string& hint) {
  const DocumentEntry* entry = at.node().find(key);
  const Document& place = entry != nullptr ? entry->value : at.node();
  throw Error({ErrorKind::input,
               code,
               at.where(place),
               fmt::format("{}: {}", at.path_of(key), what),
               entry != nullptr ? place.text : "",
               hint});
}

void refuse_scene_value(const char* code,
                        const MapReader& at,
                        const Document& node,
                        const std::string& path,
                        const std::string& what,
                        const std::string& hint) {
  throw Error({ErrorKind::input,
               code,
               at.where(node),
               fmt::format("{}: {}", path, what),
               shown(node),
               hint});
}

void check_scene_text(const MapReader& at,
                      const Document& node,
                      const std::string& path,
                      Scene& scene) {
  if (node.text.find('\0') != std::string::npos)
    refuse_scene_value("E0737", at, node, path, "a name holds a zero byte");
  if (printable(node.text) != node.text)
    scene.warnings.add("control_characters",
                       "names hold characters that cannot be printed; they are shown escaped",
                       at.where(node));
}

bool is_scalar(const Document& node) {
  return node.kind != Document::Kind::map && node.kind != Document::Kind::list;
}

void check_oversampling(const MapReader& at, std::uint64_t oversampling) {
  if (oversampling < 1 || oversampling > 1024)
    at.refuse("oversampling", "expected a whole number from 1 to 1024");
}

std::size_t index_of_name(const MapReader& at,
                          std::string_view key,
                          const std::string& name,
                          const std::vector<std::string>& names,
                          const std::string& what) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  const auto near = nearest(name, names);
  refuse_scene(
      "E0738",
      at,
      key,
      fmt::format("{} is not {}", printable(name, 40), what),
      did_you_mean(
          near,
          names.size() > 9
              ? ""
              : fmt::format("there are {}", printable(fmt::format("{}", fmt::join(names, ", "))))));
}

Scene parse_scene(std::string_view text, const std::string& path, const SceneReadOptions& options) {
  const Document document = parse_document(text, path);
  check_format(document, path, "scene", 1);
  return SceneReader(document, path, options).read();
}

bool looks_like_scene(const std::string& path) {
  const std::string small = ascii_lower(path);
  for (const char* suffix : {".yaml", ".yml", ".json"})
    if (small.ends_with(suffix)) return true;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  return ("\n" + file_text(path, 4096)).find("\nformat: scene") != std::string::npos;
}

bool is_scene_file(const std::string& path) {
  const std::string text = read_document_text(path);
  const Document document =
      path.ends_with(".json") ? parse_json_document(text, path) : parse_yaml_document(text, path);
  const DocumentEntry* format = document.find("format");
  return format != nullptr && format->value.text == "scene";
}

Scene read_scene_file(const std::string& path, const SceneReadOptions& options) {
  refuse_interrupted(path);
  const std::string text = read_document_text(path);
  Scene scene = parse_scene(text, path, options);
  Sha256 hash;
  hash.update(text);
  scene.sha256 = hash.finish();
  scene.bytes = text.size();
  return scene;
}

}  // namespace libchar

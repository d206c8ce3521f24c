#include "libchar/scene/scene_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>

#include "libchar/core/document/document.hpp"
#include "libchar/core/document/fields.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/read.hpp"
#include "libchar/scene/detail/scene_fields.hpp"
#include "libchar/scene/detail/scene_values.hpp"

namespace libchar {
namespace {

// The windows and faults of a scene file.

void check_align_terms(const MapReader& at, const SceneAlign& align) {
  for (const std::string& term : align.terms)
    if (std::find(std::begin(kAlignTerms), std::end(kAlignTerms), term) == std::end(kAlignTerms))
      throw scene_refusal("E0748", at, "terms")
          .says("{} is not a term of an alignment", printable(term, 40))
          .hint("there are {}", fmt::join(kAlignTerms, ", "));
}

SceneAlign align_of(const MapReader& top, const Scene& scene) {
  const MapReader at = top.map("align", keys_of(align_fields()));
  SceneAlign align;
  read_fields(align_fields(), at, align);
  check_align_terms(at, align);
  if (!at.has("learn")) {
    align.learn = scene.learning ? "learning" : "run";
  } else if (at.require("learn").kind == Document::Kind::list) {
    align.window = window_of(at, "learn");
  } else {
    align.learn = at.word("learn", {"rest", "learning", "run"});
    if ((align.learn == "rest" && !scene.rest) || (align.learn == "learning" && !scene.learning))
      throw scene_refusal("E0748", at, "learn")
          .says("the scene has no such window")
          .hint("learn: [from, to], or the window's own key");
  }
  if (align.by == "reference" && !scene.reference)
    throw scene_refusal("E0748", at, "by").says("the scene has no reference").hint("by: sensors");
  if (align.choose && (!scene.reference || align.by == "sensors"))
    throw scene_refusal("E0748", at, "choose").says("a reference judges what pays").hint("terms: […] without one");
  if (scene.tilt) throw scene_refusal("E0748", top, "align").says("the sensors of a tilt measure different quantities");
  return align;
}

void check_preparation(const MapReader& top, const Scene& scene) {
  const ScenePreparation& p = scene.preparation;
  if (top.has("band_hz") && top.has("high_pass_hz"))
    throw scene_refusal("E0735", top, "high_pass_hz").says("band_hz has a high-pass already").hint("give one of them");
  const char* key = p.to_hz != 0          ? "band_hz"
                    : p.filters()         ? "high_pass_hz"
                    : p.detrend != "none" ? "detrend"
                                          : "reference";
  if (const std::string why = why_not_prepared(scene); !why.empty()) throw scene_refusal("E0750", top, key).says(why);
}

// Either every sensor names as many other axes, or none does.
void check_cross(const MapReader& top, const SensorIndex& index, const Scene& scene) {
  for (std::size_t i = 0; i < scene.sensors.size(); ++i)
    if (scene.sensors[i].cross.size() != scene.sensors[0].cross.size())
      throw scene_refusal_at("E0748", top, *index.places[i].node, index.places[i].path)
          .says("sensor {} names {} other axes, and the first one {}", printable(scene.sensors[i].name, 40),
                scene.sensors[i].cross.size(), scene.sensors[0].cross.size())
          .hint("cross: the same axes of each device, in one order");
}

SensorFault fault_of(const MapReader& at, const Scene& scene, const SensorIndex& index) {
  SensorFault fault;
  fault.sensor = sensor_index(at, "sensor", scene, index);
  FaultText text;
  read_fields(fault_fields(), at, text);
  fault.kind = text.kind;
  const bool valueless = is_valueless(fault.kind);
  if (valueless && at.has("value"))
    throw scene_refusal("E0739", at, "value").says("a fault of kind {} has no value", name_of(fault.kind));
  const bool size = fault.kind == FaultKind::noise || fault.kind == FaultKind::saturation;
  if (!valueless) fault.value = at.number("value", size ? kNotNegative : kAnyNumber);
  fault.from_s = text.from_s;
  if (text.to_s) fault.to_s = *text.to_s;
  if (!(fault.from_s < fault.to_s))
    throw scene_refusal("E0740", at, "to_s").says("a fault lasts from a time to a later one");
  return fault;
}

std::vector<SensorFault> faults_of(const MapReader& from, const Scene& scene, const SensorIndex& index) {
  std::vector<SensorFault> out;
  if (!from.has("faults")) return out;
  const auto& list = from.list("faults");
  for (std::size_t i = 0; i < list.size(); ++i)
    out.push_back(fault_of(
        MapReader(list[i], from.file(), fmt::format("{}[{}]", from.path_of("faults"), i), keys_of(fault_fields())),
        scene, index));
  return out;
}

// Is a true input, or the temperature, read from a log?
bool has_recorded_signal(const Document& node) {
  const DocumentEntry* kind = node.find("kind");
  if (kind != nullptr && kind->value.text == "recording") return true;
  return std::any_of(node.list.begin(), node.list.end(), has_recorded_signal) ||
         std::any_of(node.map.begin(), node.map.end(),
                     [](const DocumentEntry& entry) { return has_recorded_signal(entry.value); });
}

// What is wrong is said at the block.
void check_simulation(const MapReader& at, const ArraySimulation& simulation) {
  try {
    check(simulation);
  } catch (const Error& error) {
    Problem problem = error.problem();
    problem.where = at.where(at.require("simulate"));
    throw Error(problem);
  }
}

// The simulation that `simulate` began with: the same sensors and faults, and its own rows h.
std::optional<ArraySimulation> simulation_again(const MapReader& at, const SimulatedFrom& from,
                                                const SceneFolder& folder, Scene& scene) {
  if (!folder.may_be_absent && has_recorded_signal(at.require("simulate"))) return std::nullopt;
  SceneFolder files = folder;
  files.may_be_absent = false;
  ArraySimulation out = scene_simulation_of(at, files, scene);
  out.seed = from.seed;
  out.oversampling = from.oversampling;
  out.deterministic = from.deterministic;
  out.faults = from.faults;
  const std::size_t inputs = out.truth.size();
  if (!from.rows.empty() && from.rows.size() != inputs * scene.sensors.size())
    throw scene_refusal("E0741", at, "rows")
        .says("expected {} weights, one per sensor and true input, found {}", inputs * scene.sensors.size(),
              from.rows.size());
  for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
    const SceneSensor& sensor = scene.sensors[i];
    out.sensors.push_back({sensor.name, sensor.model.value_or(SensorModel{}), sensor.h});
    if (!from.rows.empty())
      out.sensors[i].h.assign(from.rows.begin() + static_cast<std::ptrdiff_t>(i * inputs),
                              from.rows.begin() + static_cast<std::ptrdiff_t>((i + 1) * inputs));
  }
  check_simulation(at, out);
  return out;
}

SimulatedFrom simulated_of(const MapReader& top, const SceneFolder& folder, Scene& scene, const SensorIndex& index) {
  if (scene.simulate)
    throw scene_refusal("E0735", top, "simulated").says("tells what a recording holds; this scene has none");
  const MapReader at = top.map("simulated", keys_of(simulated_fields()));
  SimulatedFrom from;
  read_fields(simulated_fields(), at, from);
  check_oversampling(at, from.oversampling);
  from.faults = faults_of(at, scene, index);
  if (at.has("simulate")) from.simulation = simulation_again(at, from, folder, scene);
  return from;
}

/// The blocks `learning`, `evaluation`, `rest`, `fault_free_s`, `faults` and `simulated`.
void read_scene_times(const MapReader& top, const SceneFolder& folder, const SensorIndex& index, Scene& scene) {
  read_fields(scene_time_fields(), top, scene);
  scene.faults = faults_of(top, scene, index);
  check_cross(top, index, scene);
  check_preparation(top, scene);
  if (top.has("align")) scene.align = align_of(top, scene);
  if (top.has("simulated")) scene.simulated = simulated_of(top, folder, scene, index);
}

// The blocks `reference` and `tilt` of a scene file.
// The blocks `reference` and `tilt` of a scene file, and the rows h that they go with.

void read_options(const MapReader& at, const SceneFolder& folder, SceneReference& reference, Scene& scene) {
  for (const std::string& key : keys_of(reference_fields()))
    if (scene.simulate && key != "channels" && at.has(key))
      at.refuse(key, "a simulation knows its truth: name truth signals only");
  if (at.has("lag_s") && at.has("delay"))
    throw scene_refusal("E0735", at, "delay").says("lag_s says the same").hint("give one of them");
  read_fields(reference_fields(), at, reference);
  if (at.has("recording")) reference.recording = scene_recording_of(at, "recording", folder, reference.reading, scene);
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
  if (reference.channels.empty()) throw scene_refusal("E0736", at, key).says("expected the name of a channel");
  const Document& names = at.require(key);
  for (const Document& name : is_scalar(names) ? std::vector<Document>{names} : names.list)
    check_scene_text(top, name, at.path_of(key), scene);
  if (std::set<std::string>(reference.channels.begin(), reference.channels.end()).size() != reference.channels.size())
    throw scene_refusal("E0737", at, key).says("a channel is repeated");
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
    throw scene_refusal("E0747", top, "tilt").says("three different sensors make a tilt");
  if (scene.reference && !scene.reference->mean && scene.reference->channels.size() != 1)
    throw scene_refusal("E0747", top, "reference")
        .says("the reference of a tilt is one channel: the angle")
        .hint("reference: [NAME]");
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
      throw scene_refusal_at("E0741", top, *index.places[i].node, index.places[i].path)
          .says("the row h of sensor {} has {}, and there {} {}", name, plural(h.size(), "weight"),
                inputs == 1 ? "is" : "are", plural(inputs, "true input"))
          .hint("give h one weight a truth signal or reference channel");
    const bool blind = std::all_of(h.begin(), h.end(), [](double w) { return w == 0; });
    if (blind && !scene.simulate)
      throw scene_refusal_at("E0741", top, *index.places[i].node, index.places[i].path)
          .says("sensor {} sees no input: its row h is zero", name);
  }
}

// The blocks `reference` and `tilt`, and whether every row h fits the true inputs.
void read_scene_reference(const MapReader& top, const SceneFolder& folder, const SensorIndex& index, Scene& scene) {
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
      throw scene_refusal("E0735", top_, top_.has("recording") ? "simulate" : "recording")
          .says("a scene has either a recording or a simulation")
          .hint("recording: FILE, or simulate: {rate_hz, duration_s, truth}");
    if (top_.has("recording"))
      scene_.recording = scene_recording_of(top_, "recording", folder_for_again(), scene_.reading, scene_);
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
      throw scene_refusal("E0736", top_, "algorithms")
          .says("expected at least one algorithm")
          .hint("leave the key out to run every algorithm that the scene has the data for");
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
      throw scene_refusal_at("E0737", top_, name, path)
          .says("an algorithm has a name")
          .hint("{name: minque, gamma: 0.999}");
    check_scene_text(top_, name, path, scene_);
    algorithm.name = name.text;
    for (const DocumentEntry& entry : node.map) {
      if (entry.key == "name") continue;
      const std::string key = fmt::format("{}.{}", path, printable(entry.key, 40));
      if (entry.value.kind != Document::Kind::number)
        throw scene_refusal_at("E0744", top_, entry.value, key).says("an option of an algorithm is a number");
      algorithm.options.emplace_back(entry.key, entry.value.number);
    }
    return algorithm;
  }

  void finish_simulation() {
    if (!scene_.simulate) return;
    for (const SceneSensor& sensor : scene_.sensors)
      scene_.simulate->sensors.push_back({sensor.name, sensor.model.value_or(SensorModel{}), sensor.h});
    scene_.simulate->faults = scene_.faults;
    check_simulation(top_, *scene_.simulate);
  }

  MapReader top_;
  SceneFolder folder_;
  bool again_;
  Scene scene_;
};

}  // namespace

Refusal scene_refusal(const char* code, const MapReader& at, std::string_view key) {
  const DocumentEntry* entry = at.node().find(key);
  const Document& place = entry != nullptr ? entry->value : at.node();
  return input_error(code, at.where(place)).about(at.path_of(key)).got(entry != nullptr ? place.text : "");
}

Refusal scene_refusal_at(const char* code, const MapReader& at, const Document& node, const std::string& path) {
  return input_error(code, at.where(node)).about(path).got(shown(node));
}

void check_scene_text(const MapReader& at, const Document& node, const std::string& path, Scene& scene) {
  if (node.text.find('\0') != std::string::npos)
    throw scene_refusal_at("E0737", at, node, path).says("a name holds a zero byte");
  if (printable(node.text) != node.text)
    scene.warnings.add("control_characters", "names hold characters that cannot be printed; they are shown escaped",
                       at.where(node));
}

bool is_scalar(const Document& node) { return node.kind != Document::Kind::map && node.kind != Document::Kind::list; }

void check_oversampling(const MapReader& at, std::uint64_t oversampling) {
  if (oversampling < 1 || oversampling > 1024) at.refuse("oversampling", "expected a whole number from 1 to 1024");
}

std::size_t index_of_name(const MapReader& at, std::string_view key, const std::string& name,
                          const std::vector<std::string>& names, const std::string& what) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  const auto near = nearest(name, names);
  throw scene_refusal("E0738", at, key)
      .says("{} is not {}", printable(name, 40), what)
      .hint(did_you_mean(
          near,
          names.size() > 9 ? "" : fmt::format("there are {}", printable(fmt::format("{}", fmt::join(names, ", "))))));
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
  const Document document = path.ends_with(".json") ? parse_json_document(text, path) : parse_yaml_document(text, path);
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

std::string why_not_prepared(const Scene& scene) {
  const ScenePreparation& p = scene.preparation;
  if (p.from_hz < 0 || p.to_hz < 0 || (p.to_hz > 0 && !(p.from_hz > 0 && p.from_hz < p.to_hz)))
    return "a band goes from a frequency above zero to a higher one";
  if (scene.tilt && (p.filters() || p.detrend != "none"))
    return "the filters of a tilt need gravity, which this takes out";
  if (!scene.reference) return "";
  if (scene.reference->estimate_offset && (p.filters() || p.detrend != "none"))
    return "it leaves no offset of the reference to estimate";
  const bool offset = scene.reference->estimate_offset || scene.reference->offset != 0;
  if (offset && scene.reference->channels.size() > 1 && !scene.reference->mean)
    return "an offset is that of one true input";
  return "";
}

}  // namespace libchar

#include "libchar/scene/scene_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"
#include "libchar/model/model_reader.hpp"
#include "libchar/scene/detail/scene_parts.hpp"

namespace libchar {
namespace {

const std::vector<std::string> kKeys = {"format",
                                        "version",
                                        "name",
                                        "tool",
                                        "recording",
                                        "simulate",
                                        "sensors",
                                        "reference",
                                        "tilt",
                                        "learning",
                                        "evaluation",
                                        "rest",
                                        "fault_free_s",
                                        "faults",
                                        "simulated",
                                        "algorithms"};

const std::string kNeedsModel = "a simulated sensor needs a model";
const std::string kModelHint =
    "model: FILE.sensor.yaml, the keys of a model, or none for a perfect sensor";

// Without the mistake of taking a letter's case for a difference.
std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return text;
}

class SceneReader {
 public:
  SceneReader(const Document& document, const std::string& path, const SceneReadOptions& options)
      : top_(document, path, "", kKeys), folder_{path, options.allow_outside} {}

  Scene read() {
    scene_.file = folder_.scene;
    scene_.name = top_.text_or("name", "");
    if (top_.has("name")) check_text(top_.require("name"), "name");
    if (top_.has("tool")) top_.map("tool", {"name", "version"});
    if (top_.has("recording") == top_.has("simulate"))
      refuse_scene("E0735",
                   top_,
                   top_.has("recording") ? "simulate" : "recording",
                   "a scene has either a recording or a simulation",
                   "recording: FILE, or simulate: {rate_hz, duration_s, truth}");
    if (top_.has("recording"))
      scene_.recording = scene_recording_of(top_, "recording", folder_, scene_.reading, scene_);
    if (top_.has("simulate")) scene_.simulate = scene_simulation_of(top_, folder_, scene_);
    sensors();
    reference();
    if (top_.has("tilt")) tilt();
    check_rows();
    if (top_.has("learning")) scene_.learning = window("learning");
    if (top_.has("evaluation")) scene_.evaluation = window("evaluation");
    if (top_.has("rest")) scene_.rest = window("rest");
    scene_.fault_free_s = top_.maybe_number("fault_free_s", kPositive);
    if (top_.has("faults")) scene_.faults = faults(top_);
    if (top_.has("simulated")) simulated();
    if (top_.has("algorithms")) algorithms();
    finish_simulation();
    return std::move(scene_);
  }

 private:
  // A sensor as it stands in the file.
  struct Place {
    const Document* node;
    std::string path;  ///< "sensors[3]"
  };

  [[noreturn]] void refuse(const char* code,
                           const Document& node,
                           const std::string& path,
                           const std::string& what,
                           const std::string& hint = "") const {
    throw Error({ErrorKind::input,
                 code,
                 top_.where(node),
                 fmt::format("{}: {}", path, what),
                 shown(node),
                 hint});
  }

  // Names go into logs, reports and terminals.
  void check_text(const Document& node, const std::string& path) {
    if (node.text.find('\0') != std::string::npos)
      refuse("E0737", node, path, "a name holds a zero byte");
    if (printable(node.text) != node.text)
      scene_.warnings.add("control_characters",
                          "names hold characters that cannot be printed; they are shown escaped",
                          top_.where(node));
  }

  void sensors() {
    const auto& list = top_.list("sensors");
    if (list.empty()) refuse_scene("E0736", top_, "sensors", "expected at least one sensor");
    if (list.size() > kMostSensors) refuse_number(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) sensor(list[i], fmt::format("sensors[{}]", i));
    check_names();
  }

  [[noreturn]] void refuse_number(std::uint64_t number) const {
    refuse_scene(
        "E0736",
        top_,
        "sensors",
        fmt::format("{} sensors are more than the {} that a scene may have", number, kMostSensors));
  }

  void sensor(const Document& node, const std::string& path) {
    SceneSensor sensor;
    if (is_scalar(node)) {
      if (scene_.simulate) refuse("E0743", node, path, kNeedsModel, kModelHint);
      sensor.name = sensor.channel = node.text;
      return add(sensor, {&node, path});
    }
    const MapReader at(
        node, folder_.scene, path, {"name", "channel", "model", "h", "count", "scale", "noise"});
    const char* named = at.has("name") || !at.has("channel") ? "name" : "channel";
    sensor.name = at.text(named);
    sensor.channel = at.text_or("channel", sensor.name);
    const Place place{&at.require(named), at.path_of(named)};
    if (at.has("channel")) check_text(at.require("channel"), at.path_of("channel"));
    if (at.has("h")) sensor.h = at.numbers("h");
    if (sensor.h.empty()) refuse_scene("E0741", at, "h", "expected one weight a true input");
    if (at.has("model")) sensor.model = model(at);
    sensor.scale = at.number_or("scale", 1);
    if (sensor.scale == 0) at.refuse("scale", "a scale of zero leaves nothing of the samples");
    sensor.noise = at.maybe_number("noise", kPositive);
    if (scene_.simulate && at.has("scale"))
      at.refuse("scale", "the samples of a simulation are used as they are");
    if (scene_.simulate && at.has("channel"))
      at.refuse("channel", "a simulated sensor's channel has its name");
    if (scene_.simulate && !at.has("model"))
      refuse_scene("E0743", at, "model", kNeedsModel, kModelHint);
    if (at.has("count")) return devices(sensor, at, place);
    add(sensor, place);
  }

  // NAME1 … NAMEn from one model.
  void devices(SceneSensor sensor, const MapReader& at, const Place& place) {
    if (!scene_.simulate)
      at.refuse("count", "a recording has the sensors it has", "name each of them");
    const std::uint64_t count = at.count("count");
    if (count == 0) at.refuse("count", "expected at least one device");
    if (count > kMostSensors) refuse_number(count);
    const std::string name = sensor.name;
    for (std::uint64_t i = 1; i <= count; ++i) {
      sensor.name = sensor.channel = name + std::to_string(i);
      add(sensor, place);
    }
  }

  void add(const SceneSensor& sensor, const Place& place) {
    if (scene_.sensors.size() >= kMostSensors) refuse_number(scene_.sensors.size() + 1);
    if (place.node->kind == Document::Kind::null || sensor.name.empty())
      refuse("E0737", *place.node, place.path, "a sensor needs a name");
    check_text(*place.node, place.path);
    places_.push_back(place);
    scene_.sensors.push_back(sensor);
  }

  std::optional<SensorModel> model(const MapReader& at) {
    const Document& node = at.require("model");
    if (!is_scalar(node)) return sensor_model_of(node, folder_.scene, at.path_of("model"));
    if (node.text == "none") return std::nullopt;
    const std::string path = scene_file_of(at, "model", folder_, scene_);
    const auto known = models_.find(path);
    if (known != models_.end()) return known->second;
    return models_.emplace(path, read_model_file(path)).first->second;
  }

  // Equal names are refused; names that differ by capitals only are counted.
  void check_names() {
    std::map<std::string, std::size_t> small;
    for (std::size_t i = 0; i < scene_.sensors.size(); ++i) {
      const std::string& name = scene_.sensors[i].name;
      if (!index_.emplace(name, i).second)
        refuse("E0737",
               *places_[i].node,
               places_[i].path,
               fmt::format("two sensors have the name {}", printable(name, 40)));
      if (!small.emplace(lower(name), i).second)
        scene_.warnings.add(
            "case_clash", "names of sensors differ by capitals only", top_.where(*places_[i].node));
    }
  }

  void reference() {
    if (!top_.has("reference")) {
      // What was simulated is known.
      if (scene_.simulate) scene_.reference.emplace().channels = scene_.simulate->truth_names;
      return;
    }
    SceneReference reference;
    const Document& node = top_.require("reference");
    std::optional<MapReader> map;
    if (node.kind == Document::Kind::map)
      map = top_.map("reference", {"channels", "mean", "recording", "lag_s"});
    const MapReader& at = map ? *map : top_;
    const char* key = map ? "channels" : "reference";
    reference.channels = at.texts(key);
    if (reference.channels.empty())
      refuse_scene("E0736", at, key, "expected the name of a channel");
    const Document& names = at.require(key);
    for (const Document& name : is_scalar(names) ? std::vector<Document>{names} : names.list)
      check_text(name, at.path_of(key));
    if (std::set<std::string>(reference.channels.begin(), reference.channels.end()).size() !=
        reference.channels.size())
      refuse_scene("E0737", at, key, "a channel stands twice");
    if (map) reference_options(at, reference);
    if (scene_.simulate)
      for (const std::string& channel : reference.channels)
        index_of_name(at, key, channel, scene_.simulate->truth_names, "a truth signal");
    scene_.reference = std::move(reference);
  }

  void reference_options(const MapReader& at, SceneReference& reference) {
    for (const char* key : {"mean", "recording", "lag_s"})
      if (scene_.simulate && at.has(key))
        at.refuse(key, "a simulation knows its truth: name truth signals only");
    reference.mean = at.flag_or("mean", false);
    if (at.has("recording"))
      reference.recording = scene_recording_of(at, "recording", folder_, reference.reading, scene_);
    if (!at.has("lag_s")) return;
    const Document& lag = at.require("lag_s");
    reference.estimate_lag = lag.kind == Document::Kind::text && lag.text == "estimate";
    if (lag.kind == Document::Kind::text && !reference.estimate_lag)
      at.refuse("lag_s", "expected a number of seconds, or estimate");
    if (!reference.estimate_lag) reference.lag_s = at.number("lag_s");
  }

  void tilt() {
    const MapReader at = top_.map("tilt", {"gyroscope", "accelerometer_x", "accelerometer_z"});
    SceneTilt tilt;
    tilt.gyroscope = sensor_index(at, "gyroscope");
    tilt.accelerometer_x = sensor_index(at, "accelerometer_x");
    tilt.accelerometer_z = sensor_index(at, "accelerometer_z");
    if (tilt.gyroscope == tilt.accelerometer_x || tilt.gyroscope == tilt.accelerometer_z ||
        tilt.accelerometer_x == tilt.accelerometer_z)
      refuse_scene("E0747", top_, "tilt", "three different sensors make a tilt");
    if (scene_.reference && !scene_.reference->mean && scene_.reference->channels.size() != 1)
      refuse_scene("E0747",
                   top_,
                   "reference",
                   "the reference of a tilt is one channel: the angle",
                   "reference: [NAME]");
    scene_.tilt = tilt;
  }

  // Every sensor weighs the same true inputs.
  void check_rows() const {
    if (scene_.tilt && !scene_.simulate) return;
    std::size_t inputs = scene_.sensors[0].h.size();
    if (scene_.simulate)
      inputs = scene_.simulate->truth.size();
    else if (scene_.reference)
      inputs = scene_.reference->mean ? 1 : scene_.reference->channels.size();
    for (std::size_t i = 0; i < scene_.sensors.size(); ++i) {
      const std::vector<double>& h = scene_.sensors[i].h;
      const std::string name = printable(scene_.sensors[i].name, 40);
      if (h.size() != inputs)
        refuse("E0741",
               *places_[i].node,
               places_[i].path,
               fmt::format("the row h of sensor {} has {} weight{}, and there {} {} true input{}",
                           name,
                           h.size(),
                           h.size() == 1 ? "" : "s",
                           inputs == 1 ? "is" : "are",
                           inputs,
                           inputs == 1 ? "" : "s"),
               "give h one weight a truth signal or reference channel");
      const bool blind = std::all_of(h.begin(), h.end(), [](double w) { return w == 0; });
      if (blind && !scene_.simulate)
        refuse("E0741",
               *places_[i].node,
               places_[i].path,
               fmt::format("sensor {} sees no input: its row h is zero", name));
    }
  }

  // [from, to]; `end` stands for the end of the recording.
  TimeWindow window(const char* key) const {
    const auto& ends = top_.list(key);
    TimeWindow window;
    const auto number = [&](const Document& node) {
      if (node.kind != Document::Kind::number) refuse("E0740", node, key, "expected a number");
      return node.number;
    };
    if (ends.size() != 2)
      refuse_scene("E0740", top_, key, "expected [from, to] in seconds, or [from, end]");
    window.from_s = number(ends[0]);
    if (ends[1].text != "end") window.to_s = number(ends[1]);
    if (window.from_s < 0 || !(window.from_s < window.to_s))
      refuse_scene("E0740", top_, key, "expected 0 <= from < to");
    return window;
  }

  std::vector<SensorFault> faults(const MapReader& from) const {
    std::vector<SensorFault> out;
    const auto& list = from.list("faults");
    for (std::size_t i = 0; i < list.size(); ++i)
      out.push_back(fault(MapReader(list[i],
                                    folder_.scene,
                                    fmt::format("{}[{}]", from.path_of("faults"), i),
                                    {"sensor", "kind", "value", "from_s", "to_s"})));
    return out;
  }

  SensorFault fault(const MapReader& at) const {
    SensorFault fault;
    fault.sensor = sensor_index(at, "sensor");
    fault.kind = *find_enum<FaultKind>(at.word("kind", words_of<FaultKind>()));
    const bool valueless = fault.kind == FaultKind::stuck || fault.kind == FaultKind::dropout;
    if (valueless && at.has("value"))
      refuse_scene("E0739",
                   at,
                   "value",
                   fmt::format("a fault of kind {} has no value", name_of(fault.kind)));
    const bool size = fault.kind == FaultKind::noise || fault.kind == FaultKind::saturation;
    if (!valueless) fault.value = at.number("value", size ? kNotNegative : kAnyNumber);
    fault.from_s = at.number_or("from_s", 0, kNotNegative);
    if (at.has("to_s")) fault.to_s = at.number("to_s", kPositive);
    if (!(fault.from_s < fault.to_s))
      refuse_scene("E0740", at, "to_s", "a fault lasts from a time to a later one");
    return fault;
  }

  std::size_t sensor_index(const MapReader& at, const char* key) const {
    const std::string name = at.text(key);
    const auto found = index_.find(name);
    if (found != index_.end()) return found->second;
    std::vector<std::string> names;
    for (const SceneSensor& sensor : scene_.sensors) names.push_back(sensor.name);
    return index_of_name(at, key, name, names, "a sensor of this scene");
  }

  void simulated() {
    if (scene_.simulate)
      refuse_scene("E0735", top_, "simulated", "tells what a recording holds; this scene has none");
    const MapReader at = top_.map("simulated", {"seed", "oversampling", "faults"});
    SimulatedFrom from;
    from.seed = at.count_or("seed", 1);
    from.oversampling = at.count_or("oversampling", 1);
    if (from.oversampling < 1 || from.oversampling > 1024)
      at.refuse("oversampling", "expected a whole number from 1 to 1024");
    if (at.has("faults")) from.faults = faults(at);
    scene_.simulated = std::move(from);
  }

  void algorithms() {
    const auto& list = top_.list("algorithms");
    if (list.empty())
      refuse_scene("E0736",
                   top_,
                   "algorithms",
                   "expected at least one algorithm",
                   "leave the key out to run all that the scene can feed");
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
      refuse("E0737", name, path, "an algorithm has a name", "{name: minque, gamma: 0.999}");
    check_text(name, path);
    algorithm.name = name.text;
    for (const DocumentEntry& entry : node.map) {
      if (entry.key == "name") continue;
      const std::string key = fmt::format("{}.{}", path, printable(entry.key, 40));
      if (entry.value.kind != Document::Kind::number)
        refuse("E0744", entry.value, key, "an option of an algorithm is a number");
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
  Scene scene_;
  std::vector<Place> places_;                 ///< of scene_.sensors
  std::map<std::string, std::size_t> index_;  ///< of scene_.sensors by name
  std::map<std::string, SensorModel> models_;
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

bool is_scalar(const Document& node) {
  return node.kind != Document::Kind::map && node.kind != Document::Kind::list;
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
      near ? fmt::format("did you mean {}?", printable(*near, 40))
      : names.size() > 9
          ? ""
          : fmt::format("there are {}", printable(fmt::format("{}", fmt::join(names, ", ")))));
}

Scene parse_scene(std::string_view text, const std::string& path, const SceneReadOptions& options) {
  const Document document =
      path.ends_with(".json") ? parse_json_document(text, path) : parse_yaml_document(text, path);
  check_format(document, path, "scene", 1);
  return SceneReader(document, path, options).read();
}

Scene read_scene_file(const std::string& path, const SceneReadOptions& options) {
  return parse_scene(read_document_text(path), path, options);
}

}  // namespace libchar

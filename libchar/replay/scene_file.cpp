#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "libchar/core/error.hpp"
#include "libchar/core/schema.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/whole_file.hpp"
#include "libchar/model/model_reader.hpp"
#include "libchar/replay/scene.hpp"
#include "libchar/replay/scene_paths.hpp"

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
                                        "learning",
                                        "evaluation",
                                        "faults",
                                        "simulated",
                                        "algorithms"};
const std::vector<std::string> kRecordingKeys = {"file",
                                                 "rate_hz",
                                                 "delimiter",
                                                 "decimal",
                                                 "header",
                                                 "names",
                                                 "units",
                                                 "time_column",
                                                 "time_unit",
                                                 "skip_rows",
                                                 "format",
                                                 "from_s",
                                                 "to_s"};

bool is_named(const Document& node) {
  return node.kind != Document::Kind::map && node.kind != Document::Kind::list;
}

class SceneReader {
 public:
  SceneReader(const Document& document, const std::string& path, const SceneReadOptions& options)
      : top_(document, path, "", kKeys), folder_{path, options.allow_outside} {}

  Scene read() {
    scene_.file = folder_.scene;
    scene_.name = top_.text_or("name", "");
    if (top_.has("tool")) top_.map("tool", {"name", "version"});
    if (top_.has("recording") == top_.has("simulate"))
      top_.refuse(top_.has("recording") ? "simulate" : "",
                  top_.has("recording") ? "a scene has a recording or a simulation, not both"
                                        : "a scene has a recording or a simulation",
                  "recording: FILE, or simulate: {rate_hz, duration_s, truth}");
    if (top_.has("recording")) scene_.recording = recording(top_, "recording", scene_.reading);
    if (top_.has("simulate")) simulation();
    sensors();
    if (top_.has("reference")) reference();
    check_h();
    for (const char* key : {"learning", "evaluation"})
      if (top_.has(key))
        (std::string(key) == "learning" ? scene_.learning : scene_.evaluation) = window(key);
    if (top_.has("faults")) scene_.faults = faults(top_, "faults");
    if (top_.has("simulated")) simulated();
    if (top_.has("algorithms")) algorithms();
    finish_simulation();
    return std::move(scene_);
  }

 private:
  std::string file_of(const MapReader& at, const std::string& key) const {
    return resolve_scene_file(at.text(key), folder_, at.where(at.require(key)));
  }

  // A path, or a map with a path and how to read it.
  std::string recording(const MapReader& at, const std::string& key, ReadOptions& reading) const {
    if (is_named(at.require(key))) return file_of(at, key);
    const MapReader map = at.map(key, kRecordingKeys);
    reading.rate_hz = map.maybe_number("rate_hz", kPositive);
    reading.delimiter = map.text_or("delimiter", "auto");
    reading.decimal = map.word_or("decimal", {"auto", "point", "comma"}, "auto");
    reading.header = map.word_or("header", {"auto", "yes", "no"}, "auto");
    if (map.has("names")) reading.names = map.texts("names");
    if (map.has("units")) reading.units = map.texts("units");
    reading.time_column = map.text_or("time_column", "auto");
    reading.time_unit = map.word_or("time_unit", {"auto", "s", "ms", "us", "ns"}, "auto");
    reading.skip_rows = map.count_or("skip_rows", 0);
    reading.format = map.word_or("format", {"auto", "csv", "npy", "raw"}, "auto");
    reading.from_s = map.maybe_number("from_s", kNotNegative);
    reading.to_s = map.maybe_number("to_s", kPositive);
    return file_of(map, "file");
  }

  void simulation() {
    const MapReader at = top_.map("simulate",
                                  {"rate_hz",
                                   "duration_s",
                                   "samples",
                                   "seed",
                                   "oversampling",
                                   "truth",
                                   "truth_bandwidth_hz",
                                   "temperature",
                                   "low_pass_start"});
    ArraySimulation s;
    s.rate_hz = at.number("rate_hz", kPositive);
    if (at.has("samples") == at.has("duration_s"))
      at.refuse("samples", "a simulation has a duration_s or a number of samples", "");
    s.samples = at.has("samples") ? at.count("samples")
                                  : static_cast<std::uint64_t>(std::llround(
                                        at.number("duration_s", kPositive) * s.rate_hz));
    if (s.samples == 0)
      at.refuse(at.has("samples") ? "samples" : "duration_s", "there is no sample to simulate");
    s.seed = at.count_or("seed", 1);
    s.oversampling = at.count_or("oversampling", 1);
    if (s.oversampling < 1 || s.oversampling > 1024)
      at.refuse("oversampling", "expected 1 to 1024");
    s.truth_bandwidth_hz = at.maybe_number("truth_bandwidth_hz", kPositive);
    s.low_pass_starts_at_zero =
        at.word_or("low_pass_start", {"steady", "zero"}, "steady") == "zero";
    if (at.has("truth")) truth(at, s);
    if (at.has("temperature"))
      s.temperature = signal(at.require("temperature"), at.path_of("temperature"), s.rate_hz);
    scene_.simulate = std::move(s);
  }

  void truth(const MapReader& at, ArraySimulation& s) {
    const Document& node = at.require("truth");
    if (node.kind != Document::Kind::list) {
      s.truth = {signal(node, at.path_of("truth"), s.rate_hz)};
      s.truth_names = {name_of_signal(node, "truth")};
      return;
    }
    if (node.list.empty()) at.refuse("truth", "expected at least one signal");
    s.truth.clear();
    s.truth_names.clear();
    for (std::size_t j = 0; j < node.list.size(); ++j) {
      s.truth.push_back(signal(node.list[j], at.path_of("truth"), s.rate_hz));
      s.truth_names.push_back(name_of_signal(node.list[j], fmt::format("truth{}", j + 1)));
    }
  }

  static std::string name_of_signal(const Document& node, const std::string& fallback) {
    const DocumentEntry* name = node.find("name");
    return name == nullptr ? fallback : name->value.text;
  }

  SignalSpec signal(const Document& node, const std::string& path, double rate_hz) const {
    SignalSpec spec = read_signal(node, folder_.scene, path);
    if (spec.kind != "recording") return spec;
    const MapReader at(node, folder_.scene, path, {"kind", "name", "offset", "file", "channel"});
    ReadOptions reading;
    reading.hash = false;
    if (!spec.channel.empty()) reading.channels = {spec.channel};
    const Recording log = read_recording(file_of(at, "file"), reading);
    if (log.info.time.rate_hz > 0 && std::abs(log.info.time.rate_hz / rate_hz - 1) > 1e-4)
      at.refuse("file",
                fmt::format("is a recording at {} Hz, and the simulation runs at {} Hz",
                            significant(log.info.time.rate_hz, 6),
                            significant(rate_hz, 6)));
    spec.samples = log.samples.at(0);
    if (spec.samples.empty()) at.refuse("file", "holds no sample");
    return spec;
  }

  void sensors() {
    const auto& list = top_.list("sensors");
    if (list.empty()) top_.refuse("sensors", "expected at least one sensor");
    if (list.size() > kMostSensors)
      top_.refuse("sensors",
                  fmt::format("{} sensors, and the limit is {}", list.size(), kMostSensors));
    for (const Document& node : list) sensor(node);
    check_names();
  }

  void sensor(const Document& node) {
    SceneSensor sensor;
    if (is_named(node)) {
      sensor.name = sensor.channel = node.text;
      add(sensor, node);
      return;
    }
    const MapReader at(node, folder_.scene, "sensors", {"name", "channel", "model", "h", "count"});
    sensor.name = at.has("name") ? at.text("name") : at.text("channel");
    sensor.channel = at.text_or("channel", sensor.name);
    if (sensor.name.empty()) at.refuse("name", "a sensor has a name");
    if (at.has("h")) sensor.h = at.numbers("h");
    if (at.has("model")) sensor.model = model(at);
    if (scene_.simulate && !sensor.model)
      at.refuse("model",
                "a simulated sensor needs a model",
                "model: FILE.sensor.yaml, or the keys of a model here");
    const std::uint64_t count = at.count_or("count", 1);
    if (count == 0 || count > kMostSensors)
      at.refuse("count", fmt::format("expected 1 to {} devices", kMostSensors));
    if (at.has("count") && !scene_.simulate)
      at.refuse("count", "a recording has the sensors it has: name each");
    if (at.has("count")) {
      const std::string name = sensor.name;
      for (std::uint64_t i = 1; i <= count; ++i) {
        sensor.name = sensor.channel = name + std::to_string(i);
        add(sensor, node);
      }
      return;
    }
    add(sensor, node);
  }

  void add(const SceneSensor& sensor, const Document& node) {
    if (scene_.sensors.size() >= kMostSensors)
      top_.refuse("sensors", fmt::format("more than {} sensors", kMostSensors));
    const DocumentEntry* name = node.find("name");
    places_.push_back(name != nullptr ? &name->value : &node);
    scene_.sensors.push_back(sensor);
  }

  SensorModel model(const MapReader& at) const {
    const Document& node = at.require("model");
    if (node.kind == Document::Kind::map)
      return sensor_model_of(node, folder_.scene, at.path_of("model"));
    return read_model_file(file_of(at, "model"));
  }

  // Equal names are refused; names that differ by capitals only are counted.
  void check_names() {
    std::set<std::string> names, small;
    for (std::size_t i = 0; i < scene_.sensors.size(); ++i) {
      const std::string& name = scene_.sensors[i].name;
      if (!names.insert(name).second)
        throw Error({ErrorKind::input,
                     "E0561",
                     top_.where(*places_[i]),
                     "two sensors have one name",
                     name,
                     ""});
      std::string lower = name;
      std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) {
        return static_cast<char>(std::tolower(c));
      });
      if (!small.insert(lower).second)
        scene_.warnings.add("case_clash", "sensors whose names differ by capitals only", name);
    }
  }

  void reference() {
    SceneReference reference;
    const Document& node = top_.require("reference");
    if (node.kind != Document::Kind::map) {
      reference.channels = top_.texts("reference");
    } else {
      const MapReader at = top_.map("reference", {"channels", "mean", "recording", "lag_s"});
      reference.channels = at.texts("channels");
      reference.mean = at.flag_or("mean", false);
      if (at.has("recording")) reference.recording = recording(at, "recording", reference.reading);
      if (at.has("lag_s")) {
        reference.estimate_lag = at.require("lag_s").text == "estimate";
        if (!reference.estimate_lag) reference.lag_s = at.number("lag_s");
      }
    }
    if (reference.channels.empty()) top_.refuse("reference", "expected the name of a channel");
    scene_.reference = std::move(reference);
  }

  // Every sensor weighs the same truth signals.
  void check_h() {
    std::size_t inputs = scene_.sensors[0].h.size();
    if (scene_.simulate)
      inputs = scene_.simulate->truth.size();
    else if (scene_.reference && !scene_.reference->mean)
      inputs = scene_.reference->channels.size();
    for (std::size_t i = 0; i < scene_.sensors.size(); ++i) {
      const SceneSensor& sensor = scene_.sensors[i];
      if (sensor.h.size() != inputs)
        throw Error({ErrorKind::input,
                     "E0562",
                     top_.where(*places_[i]),
                     fmt::format("sensor {} has a row h of {}, and there {} {} true input{}",
                                 sensor.name,
                                 sensor.h.size(),
                                 inputs == 1 ? "is" : "are",
                                 inputs,
                                 inputs == 1 ? "" : "s"),
                     "",
                     "h: one weight a true input"});
      if (std::all_of(sensor.h.begin(), sensor.h.end(), [](double w) { return w == 0; }) &&
          !scene_.simulate)
        throw Error({ErrorKind::input,
                     "E0562",
                     top_.where(*places_[i]),
                     fmt::format("sensor {} sees no input: its row h is zero", sensor.name),
                     "",
                     ""});
    }
  }

  TimeWindow window(const char* key) const {
    const auto ends = top_.interval(key);
    if (ends.first < 0 || !(ends.first < ends.second))
      top_.refuse(key, "expected [from_s, to_s] with 0 <= from_s < to_s");
    return {ends.first, ends.second};
  }

  std::vector<SensorFault> faults(const MapReader& from, const std::string& key) const {
    std::vector<SensorFault> out;
    for (const Document& node : from.list(key)) {
      const MapReader at(
          node, folder_.scene, from.path_of(key), {"sensor", "kind", "value", "from_s", "to_s"});
      SensorFault fault;
      fault.sensor = sensor_index(at);
      fault.kind = fault_kind(at.word("kind", fault_kinds()));
      const bool valueless = fault.kind == FaultKind::stuck || fault.kind == FaultKind::dropout;
      if (valueless && at.has("value"))
        at.refuse("value", fmt::format("a fault of kind {} has no value", name_of(fault.kind)));
      const bool size = fault.kind == FaultKind::noise || fault.kind == FaultKind::saturation;
      if (!valueless) fault.value = at.number("value", size ? kNotNegative : kAnyNumber);
      fault.from_s = at.number_or("from_s", 0, kNotNegative);
      if (at.has("to_s")) fault.to_s = at.number("to_s", kPositive);
      if (!(fault.from_s < fault.to_s)) at.refuse("to_s", "a fault ends after its beginning");
      out.push_back(fault);
    }
    return out;
  }

  std::size_t sensor_index(const MapReader& at) const {
    std::vector<std::string> names;
    for (const SceneSensor& sensor : scene_.sensors) names.push_back(sensor.name);
    const std::string name = at.word("sensor", names);
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  }

  void simulated() {
    const MapReader at = top_.map("simulated", {"seed", "faults"});
    SimulatedFrom from;
    from.seed = at.count_or("seed", 1);
    if (at.has("faults")) from.faults = faults(at, "faults");
    scene_.simulated = std::move(from);
  }

  void algorithms() {
    for (const Document& node : top_.list("algorithms")) {
      SceneAlgorithm algorithm;
      algorithm.line = node.line;
      algorithm.column = node.column;
      if (node.kind == Document::Kind::map) {
        for (const DocumentEntry& entry : node.map) {
          if (entry.key == "name")
            algorithm.name = entry.value.text;
          else if (entry.value.kind == Document::Kind::number)
            algorithm.options.emplace_back(entry.key, entry.value.number);
          else
            throw Error({ErrorKind::input,
                         "E0563",
                         top_.where(entry.value),
                         "an option of an algorithm is a number",
                         entry.value.text,
                         ""});
        }
      } else {
        algorithm.name = node.text;
      }
      if (algorithm.name.empty())
        throw Error({ErrorKind::input,
                     "E0563",
                     top_.where(node),
                     "an algorithm has a name",
                     "",
                     "{name: minque, gamma: 0.999}"});
      scene_.algorithms.push_back(std::move(algorithm));
    }
  }

  void finish_simulation() {
    if (!scene_.simulate) return;
    for (const SceneSensor& sensor : scene_.sensors)
      scene_.simulate->sensors.push_back({sensor.name, *sensor.model, sensor.h});
    scene_.simulate->faults = scene_.faults;
    try {
      check(*scene_.simulate);
    } catch (const Error& error) {
      Fault fault = error.fault();
      fault.where = top_.where(top_.require("simulate"));
      throw Error(fault);
    }
  }

  MapReader top_;
  SceneFolder folder_;
  Scene scene_;
  std::vector<const Document*> places_;
};

}  // namespace

Scene parse_scene(std::string_view text, const std::string& path, const SceneReadOptions& options) {
  const Document document =
      path.ends_with(".json") ? parse_json_document(text, path) : parse_yaml_document(text, path);
  check_format(document, path, "scene", 1);
  return SceneReader(document, path, options).read();
}

Scene read_scene_file(const std::string& path, const SceneReadOptions& options) {
  return parse_scene(read_document_text(path), path, options);
}

void refuse_scene_outputs(const Scene& scene, const std::vector<std::string>& outputs) {
  std::set<std::string> seen;
  for (const std::string& output : outputs) {
    for (const std::string& input :
         {scene.file,
          scene.recording,
          scene.reference && scene.reference->recording ? *scene.reference->recording
                                                        : std::string()})
      if (!input.empty()) refuse_same_file(input, output);
    std::error_code problem;
    if (!seen.insert(std::filesystem::weakly_canonical(output, problem).string()).second)
      throw Error({ErrorKind::output, "E0564", output, "two outputs have one name", "", ""});
  }
}

}  // namespace libchar

// The scene as YAML: the rows of scene_fields, and what ties the blocks together (names of sensors for
// their indices, paths for files).

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/model/model_fields.hpp"
#include "libchar/scene/detail/scene_fields.hpp"
#include "libchar/scene/detail/scene_values.hpp"
#include "libchar/scene/scene_file.hpp"

namespace libchar {

namespace {

Json any_of(Json one, Json other) { return {{"anyOf", {std::move(one), std::move(other)}}}; }

}  // namespace

Json scene_schema() {
  Json out = schema_of(scene_fields().rows, true), reading = schema_of(scene_reading_fields().rows, true);
  Json& keys = out["properties"];
  const Json text = {{"type", "string"}};
  reading["properties"]["path"] = text;
  keys["recording"] = any_of(text, std::move(reading));
  Json simulate = schema_of(simulation_fields().rows, true);
  simulate["properties"]["truth"]["type"] = {"array", "object", "number", "string"};
  keys["simulate"] = std::move(simulate);
  keys["sensors"]["items"] = any_of(text, schema_of(sensor_fields().rows, true));
  keys["reference"] = any_of({{"type", {"string", "array", "null"}}}, schema_of(reference_fields().rows, true));
  keys["tilt"] = schema_of(tilt_fields().rows, true);
  keys["faults"]["items"] = schema_of(fault_fields().rows, true);
  keys["simulated"] = schema_of(simulated_fields().rows, true);
  return out;
}

namespace {

using Entries = std::vector<Entry>;

void append(Entries& to, Entries more) {
  for (Entry& entry : more) to.push_back(std::move(entry));
}

// A scene of thousands of devices is read again: the comments of their models are left out.
Entries without_comments(Entries entries) {
  for (Entry& entry : entries) {
    entry.comment.clear();
    entry.gap = false;
    entry.below = without_comments(std::move(entry.below));
  }
  return entries;
}

// A recording with what its reading needs beside the file's own word.
Entry recording_entry(const std::string& file, ReadOptions reading, const std::string& scene,
                      std::optional<double> resample_hz = {}) {
  if (!reading.unsaid.msg.empty()) reading.unsaid.msg = path_for_scene(reading.unsaid.msg, scene);
  Entries more;
  if (resample_hz) more.push_back({"resample_hz", *resample_hz});
  append(more, entries_of(scene_reading_fields(), reading));
  const std::string path = path_for_scene(file, scene);
  if (more.empty()) return {"recording", path};
  more.insert(more.begin(), {"file", path});
  return part_entry("recording", std::move(more));
}

// [[seconds, value], …]
Entry points_entry(const std::vector<std::pair<double, double>>& points) {
  std::string text;
  for (const auto& [time, value] : points)
    text += fmt::format("{}[{}, {}]", text.empty() ? "" : ", ", shortest_yaml(time), shortest_yaml(value));
  return word_entry("points", "[" + text + "]");
}

// Everything that differs from a signal of the same kind without keys.
Entries signal_entries(const SignalSpec& s, const std::string& name, const std::vector<std::string>& truth_names,
                       const std::string& scene) {
  const std::vector<std::string>& keys = signal_keys(s.kind);
  const auto has = [&](std::string_view key) {
    return key == "offset" || std::find(keys.begin(), keys.end(), key) != keys.end();
  };
  Entries out = {word_entry("kind", s.kind)};
  if (!name.empty()) out.push_back({"name", name});
  for (Entry& entry : entries_of(signal_fields(), s))
    if (has(entry.key)) out.push_back(std::move(entry));
  if (has("of")) out.push_back({"of", truth_names.at(s.of)});
  if (has("points")) out.push_back(points_entry(s.points));
  if (s.kind == "recording") {
    out.push_back({"file", path_for_scene(s.file, scene)});
    if (!s.channel.empty()) out.push_back({"channel", s.channel});
  }
  return out;
}

// In the order of the table.
Entries ordered(Entries entries, const std::vector<std::string>& keys) {
  const auto place = [&](const Entry& entry) { return std::find(keys.begin(), keys.end(), entry.key); };
  std::stable_sort(entries.begin(), entries.end(), [&](const Entry& a, const Entry& b) { return place(a) < place(b); });
  return entries;
}

Entry simulation_entry(const ArraySimulation& s, const std::string& file) {
  const auto signal = [&](std::string key, const SignalSpec& spec, const std::string& name) {
    return part_entry(std::move(key), signal_entries(spec, name, s.truth_names, file), Entry::Form::flow);
  };
  Entries below = entries_of(simulation_fields(), s);
  below.push_back({"samples", s.samples});
  Entries truth;
  for (std::size_t j = 0; j < s.truth.size(); ++j) truth.push_back(signal("", s.truth[j], s.truth_names[j]));
  below.push_back(part_entry("truth", std::move(truth), Entry::Form::list));
  if (s.temperature) below.push_back(signal("temperature", *s.temperature, ""));
  return part_entry("simulate", ordered(std::move(below), keys_of(simulation_fields())));
}

Entry sensor_entry(const SceneSensor& sensor, bool simulated) {
  SceneSensor said = sensor;
  if (simulated || sensor.channel == sensor.name) said.channel.clear();
  Entries below = entries_of(sensor_fields(), said);
  if (sensor.model)
    below.push_back(part_entry("model", without_comments(model_entries(*sensor.model))));
  else if (simulated)
    below.push_back(word_entry("model", "none"));
  return part_entry("", std::move(below));
}

Entry sensors_entry(const Scene& scene) {
  Entries below;
  for (const SceneSensor& sensor : scene.sensors) below.push_back(sensor_entry(sensor, scene.simulate.has_value()));
  return part_entry("sensors", std::move(below), Entry::Form::list);
}

Entry reference_entry(const SceneReference& r, const std::string& scene) {
  if (!r.mean && !r.recording && r.lag_s == 0 && !r.estimate_lag && r.offset == 0 && !r.estimate_offset && r.teach &&
      r.samples == "estimate")
    return {"reference", r.channels};
  Entries below = entries_of(reference_fields(), r);
  below.push_back({"channels", r.channels});
  if (r.recording) below.push_back(recording_entry(*r.recording, r.reading, scene));
  return part_entry("reference", ordered(std::move(below), keys_of(reference_fields())));
}

Entry tilt_entry(const Scene& scene) {
  const auto name = [&](std::size_t sensor) { return scene.sensors[sensor].name; };
  const TiltText text{name(scene.tilt->gyroscope), name(scene.tilt->accelerometer_x),
                      name(scene.tilt->accelerometer_z)};
  return part_entry("tilt", entries_of(tilt_fields(), text), Entry::Form::flow);
}

Entry align_entry(const SceneAlign& align) {
  Entries below;
  if (align.window)
    write_window("learn", align.window, below);
  else
    below.push_back(word_entry("learn", align.learn));
  append(below, entries_of(align_fields(), align));
  return part_entry("align", std::move(below));
}

Entry faults_entry(const std::vector<SensorFault>& faults, const Scene& scene) {
  Entries below;
  for (const SensorFault& fault : faults) {
    FaultText text{scene.sensors[fault.sensor].name, fault.kind, {}, fault.from_s, {}};
    if (!is_valueless(fault.kind)) text.value = fault.value;
    if (std::isfinite(fault.to_s)) text.to_s = fault.to_s;
    below.push_back(part_entry("", entries_of(fault_fields(), text), Entry::Form::flow));
  }
  return part_entry("faults", std::move(below), Entry::Form::list);
}

Entry simulated_entry(const Scene& scene) {
  Entries below = entries_of(simulated_fields(), *scene.simulated);
  if (!scene.simulated->faults.empty()) below.push_back(faults_entry(scene.simulated->faults, scene));
  if (scene.simulated->simulation) below.push_back(simulation_entry(*scene.simulated->simulation, scene.file));
  Entry entry = part_entry("simulated", std::move(below));
  entry.comment = "what the recording is known to hold; not injected again";
  return entry;
}

Entry algorithms_entry(const Scene& scene) {
  Entries list;
  for (const SceneAlgorithm& algorithm : scene.algorithms) {
    Entries below = {{"name", algorithm.name}};
    for (const auto& [key, value] : algorithm.options) below.push_back({quoted_yaml(key), value});
    list.push_back(part_entry("", std::move(below), Entry::Form::flow));
  }
  return part_entry("algorithms", std::move(list), Entry::Form::list);
}

Entries head(const Scene& scene) {
  Entries out = {word_entry("format", "scene"), {"version", std::uint64_t{1}}, tool_entry()};
  if (!scene.name.empty()) out.push_back({"name", scene.name});
  return out;
}

Entries scene_entries(const Scene& scene) {
  Entries out = head(scene);
  out.push_back(scene.simulate ? simulation_entry(*scene.simulate, scene.file)
                               : recording_entry(scene.recording, scene.reading, scene.file, scene.resample_hz));
  out.push_back(sensors_entry(scene));
  if (scene.reference) out.push_back(reference_entry(*scene.reference, scene.file));
  if (scene.tilt) out.push_back(tilt_entry(scene));
  append(out, entries_of(scene_time_fields(), scene));
  if (scene.align) out.push_back(align_entry(*scene.align));
  if (!scene.faults.empty()) out.push_back(faults_entry(scene.faults, scene));
  if (scene.simulated) out.push_back(simulated_entry(scene));
  if (!scene.algorithms.empty()) out.push_back(algorithms_entry(scene));
  return ordered(std::move(out), keys_of(scene_fields()));
}

}  // namespace

std::string scene_yaml(const Scene& scene) {
  return "# A recording of sensors and what is known about it: docs/scenes.md\n" + yaml_of(scene_entries(scene));
}

}  // namespace libchar

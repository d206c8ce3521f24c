// The scene as YAML, written by hand as model files are (model/model_file.cpp): every number reads
// back to the same double, every text to the same text.

#include "libchar/scene/scene_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/text.hpp"
#include "libchar/core/version.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/scene/detail/scene_paths.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {
namespace {

std::string list_of(const std::vector<std::string>& texts) {
  std::string out;
  for (const std::string& text : texts) out += (out.empty() ? "" : ", ") + quoted_yaml(text);
  return "[" + out + "]";
}

std::string list_of(const std::vector<double>& numbers) {
  std::string out;
  for (const double number : numbers) out += (out.empty() ? "" : ", ") + shortest_yaml(number);
  return "[" + out + "]";
}

// A recording with what its reading needs beside the file's own word.
std::string recording_block(const std::string& file,
                            const ReadOptions& r,
                            const std::string& scene,
                            const std::string& indent,
                            std::optional<double> resample_hz = {}) {
  std::string more;
  const auto add = [&](const std::string& key, const std::string& value) {
    more += indent + "  " + key + ": " + value + "\n";
  };
  if (resample_hz) add("resample_hz", shortest_yaml(*resample_hz));
  if (r.rate_hz) add("rate_hz", shortest_yaml(*r.rate_hz));
  if (r.delimiter != "auto") add("delimiter", quoted_yaml(r.delimiter));
  if (r.decimal != "auto") add("decimal", r.decimal);
  if (r.header != "auto") add("header", quoted_yaml(r.header));
  if (r.encoding != "utf-8") add("encoding", r.encoding);
  if (!r.names.empty()) add("names", list_of(r.names));
  if (!r.units.empty()) add("units", list_of(r.units));
  if (r.time_column != "auto") add("time_column", quoted_yaml(r.time_column));
  if (r.time_unit != "auto") add("time_unit", r.time_unit);
  if (r.skip_rows > 0) add("skip_rows", std::to_string(r.skip_rows));
  if (r.format != "auto") add("format", r.format);
  if (r.from_s) add("from_s", shortest_yaml(*r.from_s));
  if (r.to_s) add("to_s", shortest_yaml(*r.to_s));
  if (r.overflow_as_missing) add("overflow_as_missing", "true");
  if (r.skip_repeated_header) add("skip_repeated_header", "true");
  const std::string path = quoted_yaml(path_for_scene(file, scene));
  return indent + "recording: " +
         (more.empty() ? path + "\n" : "\n" + indent + "  file: " + path + "\n" + more);
}

// Everything that differs from a signal of the same kind without keys.
std::string signal_text(const SignalSpec& s,
                        const std::string& name,
                        const std::vector<std::string>& truth_names,
                        const std::string& scene) {
  const SignalSpec plain;
  std::string out = "{kind: " + s.kind;
  if (!name.empty()) out += ", name: " + quoted_yaml(name);
  const auto number = [&](const char* key, double value, double fallback) {
    const auto& keys = signal_keys(s.kind);
    if (std::find(keys.begin(), keys.end(), key) != keys.end() && value != fallback)
      out += fmt::format(", {}: {}", key, shortest_yaml(value));
  };
  if (s.offset != 0) out += ", offset: " + shortest_yaml(s.offset);
  number("value", s.value, kMissing);
  number("amplitude", s.amplitude, plain.amplitude);
  number("frequency_hz", s.frequency_hz, plain.frequency_hz);
  number("phase_rad", s.phase_rad, plain.phase_rad);
  number("from_hz", s.from_hz, plain.from_hz);
  number("to_hz", s.to_hz, plain.to_hz);
  number("standard_deviation", s.standard_deviation, plain.standard_deviation);
  number("bandwidth_hz", s.bandwidth_hz, plain.bandwidth_hz);
  number("renew_s", s.renew_s, plain.renew_s);
  number("repeat", s.repeat, plain.repeat);
  number("step", s.step, plain.step);
  number("slope", s.slope, kMissing);
  if (s.kind == "derivative" || s.kind == "sine_of" || s.kind == "cosine_of")
    out += ", of: " + quoted_yaml(truth_names.at(s.of));
  if (s.kind == "points") {
    out += ", points: [";
    for (std::size_t i = 0; i < s.points.size(); ++i)
      out += fmt::format("{}[{}, {}]",
                         i == 0 ? "" : ", ",
                         shortest_yaml(s.points[i].first),
                         shortest_yaml(s.points[i].second));
    out += "]";
  }
  if (s.kind == "recording") {
    out += ", file: " + quoted_yaml(path_for_scene(s.file, scene));
    if (!s.channel.empty()) out += ", channel: " + quoted_yaml(s.channel);
  }
  return out + "}";
}

std::string simulation_block(const Scene& scene) {
  const ArraySimulation& s = *scene.simulate;
  std::string out = fmt::format("simulate:\n  rate_hz: {}\n  samples: {}\n  seed: {}\n",
                                shortest_yaml(s.rate_hz),
                                s.samples,
                                s.seed);
  if (s.oversampling > 1) out += fmt::format("  oversampling: {}\n", s.oversampling);
  out += "  truth:\n";
  for (std::size_t j = 0; j < s.truth.size(); ++j)
    out += "    - " + signal_text(s.truth[j], s.truth_names[j], s.truth_names, scene.file) + "\n";
  if (s.truth_bandwidth_hz)
    out += "  truth_bandwidth_hz: " + shortest_yaml(*s.truth_bandwidth_hz) + "\n";
  if (s.temperature)
    out += "  temperature: " + signal_text(*s.temperature, "", s.truth_names, scene.file) + "\n";
  if (s.low_pass_starts_at_zero) out += "  low_pass_start: zero\n";
  return out;
}

// A line without the comment behind it; a # in a quoted text is none.
std::string_view without_comment(std::string_view line) {
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (quoted && line[i] == '\\') {
      ++i;
    } else if (line[i] == '"') {
      quoted = !quoted;
    } else if (!quoted && line[i] == '#') {
      line = line.substr(0, i);
    }
  }
  return line.substr(0, line.find_last_not_of(' ') + 1);
}

// The model file itself, its comments left out (a scene of thousands of devices is read again),
// indented under its key.
std::string inline_model(const SensorModel& model, const std::string& indent) {
  const std::string text = model_yaml(model);
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = without_comment(std::string_view(text).substr(at, end - at));
    if (!line.empty()) out.append(indent).append(line).append("\n");
    at = end + 1;
  }
  return out;
}

std::string sensors_block(const Scene& scene) {
  std::string out = "sensors:\n";
  for (const SceneSensor& sensor : scene.sensors) {
    out += "  - name: " + quoted_yaml(sensor.name) + "\n";
    if (sensor.channel != sensor.name && !scene.simulate)
      out += "    channel: " + quoted_yaml(sensor.channel) + "\n";
    if (sensor.h != std::vector<double>{1}) out += "    h: " + list_of(sensor.h) + "\n";
    if (sensor.scale != 1) out += "    scale: " + shortest_yaml(sensor.scale) + "\n";
    if (sensor.noise) out += "    noise: " + shortest_yaml(*sensor.noise) + "\n";
    if (sensor.model)
      out += "    model:\n" + inline_model(*sensor.model, "      ");
    else if (scene.simulate)
      out += "    model: none\n";
  }
  return out;
}

std::string reference_block(const SceneReference& r, const std::string& scene) {
  if (!r.mean && !r.recording && r.lag_s == 0 && !r.estimate_lag)
    return "reference: " + list_of(r.channels) + "\n";
  std::string out = "reference:\n  channels: " + list_of(r.channels) + "\n";
  if (r.mean) out += "  mean: true\n";
  if (r.recording) out += recording_block(*r.recording, r.reading, scene, "  ");
  if (r.estimate_lag)
    out += "  lag_s: estimate\n";
  else if (r.lag_s != 0)
    out += "  lag_s: " + shortest_yaml(r.lag_s) + "\n";
  return out;
}

std::string faults_block(const std::vector<SensorFault>& faults,
                         const Scene& scene,
                         const std::string& indent) {
  std::string out = indent + "faults:\n";
  for (const SensorFault& fault : faults) {
    const bool valueless = fault.kind == FaultKind::stuck || fault.kind == FaultKind::dropout;
    out += fmt::format("{}  - {{sensor: {}, kind: {}",
                       indent,
                       quoted_yaml(scene.sensors[fault.sensor].name),
                       name_of(fault.kind));
    if (!valueless) out += ", value: " + shortest_yaml(fault.value);
    out += ", from_s: " + shortest_yaml(fault.from_s);
    if (std::isfinite(fault.to_s)) out += ", to_s: " + shortest_yaml(fault.to_s);
    out += "}\n";
  }
  return out;
}

std::string algorithms_block(const Scene& scene) {
  std::string out = "algorithms:\n";
  for (const SceneAlgorithm& algorithm : scene.algorithms) {
    out += "  - {name: " + quoted_yaml(algorithm.name);
    for (const auto& [key, value] : algorithm.options)
      out += ", " + quoted_yaml(key) + ": " + shortest_yaml(value);
    out += "}\n";
  }
  return out;
}

}  // namespace

std::string scene_yaml(const Scene& scene) {
  std::string out = fmt::format(
      "# A recording of sensors and what is known about it: "
      "docs/scenes.md\nformat: scene\nversion: 1\ntool: {{name: sensorchar, version: {}}}\n",
      quoted_yaml(version()));
  if (!scene.name.empty()) out += "name: " + quoted_yaml(scene.name) + "\n";
  out += scene.simulate
             ? simulation_block(scene)
             : recording_block(scene.recording, scene.reading, scene.file, "", scene.resample_hz);
  out += sensors_block(scene);
  if (scene.reference) out += reference_block(*scene.reference, scene.file);
  if (scene.tilt)
    out += fmt::format("tilt: {{gyroscope: {}, accelerometer_x: {}, accelerometer_z: {}}}\n",
                       quoted_yaml(scene.sensors[scene.tilt->gyroscope].name),
                       quoted_yaml(scene.sensors[scene.tilt->accelerometer_x].name),
                       quoted_yaml(scene.sensors[scene.tilt->accelerometer_z].name));
  const auto window = [&](const char* key, const std::optional<TimeWindow>& w) {
    if (w)
      out += fmt::format("{}: [{}, {}]\n",
                         key,
                         shortest_yaml(w->from_s),
                         std::isfinite(w->to_s) ? shortest_yaml(w->to_s) : "end");
  };
  window("learning", scene.learning);
  window("evaluation", scene.evaluation);
  window("rest", scene.rest);
  if (scene.fault_free_s) out += "fault_free_s: " + shortest_yaml(*scene.fault_free_s) + "\n";
  if (!scene.faults.empty()) out += faults_block(scene.faults, scene, "");
  if (scene.simulated) {
    out += fmt::format(
        "simulated:  # what the recording is known to hold; not injected again\n  seed: {}\n",
        scene.simulated->seed);
    if (scene.simulated->oversampling > 1)
      out += fmt::format("  oversampling: {}\n", scene.simulated->oversampling);
    if (!scene.simulated->faults.empty()) out += faults_block(scene.simulated->faults, scene, "  ");
  }
  if (!scene.algorithms.empty()) out += algorithms_block(scene);
  return out;
}

}  // namespace libchar

// sensorchar model FILE…: what a sensor model says, and the same numbers for the programs that
// consume them (--to NAME). --to c takes the result of a replay: its method as one C99 file.

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/export/exports.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/replay/device_source.hpp"
#include "libchar/report/text/characterization_text.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct ModelVerb {
  std::vector<std::string> files, places;
  std::string target, output;
  ExportOptions options;
  std::string algorithm, dtype = "f64";  // of --to c
  bool list = false, force = false, json = false;
};

struct ReadModels {
  std::vector<SensorModel> models;
  std::vector<LogInfo> files;
};

ReadModels read_all(const ModelVerb& verb) {
  ReadModels read;
  for (const std::string& place : verb.files)
    for (const std::string& file : model_files(place)) {
      const std::vector<SensorModel> models = read_model_list(file);
      read.models.insert(read.models.end(), models.begin(), models.end());
      read.files.push_back(document_info(file));
    }
  return read;
}

AxisOverrides overrides(const std::vector<std::string>& places) {
  AxisOverrides out;
  for (const std::string& text : places) {
    const std::size_t sign = text.rfind('=');
    if (sign == std::string::npos || sign == 0 || sign + 1 == text.size())
      throw usage_error("E0581", "--axis").says("expected CHANNEL=PLACE").got(text).hint("such as --axis imu_3=gx");
    out.emplace_back(text.substr(0, sign), text.substr(sign + 1));
  }
  return out;
}

Json head_of(const Session& session, const char* format, const std::vector<LogInfo>& files) {
  std::vector<const LogInfo*> inputs;
  inputs.reserve(files.size());
  for (const LogInfo& info : files) inputs.push_back(&info);
  return document_head(session, format, inputs);
}

/// The only target that is not made of sensor models.
constexpr const char* kDevice = "c";
constexpr const char* kDeviceTitle = "C99 code of a replay's method";
constexpr const char* kDeviceConvention = "one file without heap; float or double (--dtype)";

bool to_device(const ModelVerb& verb) { return verb.target == kDevice; }

void print_targets(const Session& session, bool json) {
  if (json) {
    Json document = head_of(session, "model-targets", {});
    document["targets"] = Json::array();
    for (const ExportTarget& t : export_targets())
      document["targets"].push_back({{"name", t.name},
                                     {"title", t.title},
                                     {"convention", t.convention},
                                     {"file", t.file},
                                     {"needs", needs_text(t.needs)}});
    document["targets"].push_back({{"name", kDevice},
                                   {"title", kDeviceTitle},
                                   {"convention", kDeviceConvention},
                                   {"file", "fusion.c"},
                                   {"needs", "fusion.yaml"}});
    return print(dump_json(document));
  }
  std::string text;
  for (const ExportTarget& t : export_targets())
    text += fmt::format("{:<13} {} ({}; needs {})\n{:<13} {}\n", t.name, t.title, t.file, needs_text(t.needs), "",
                        t.convention);
  text +=
      fmt::format("{:<13} {} (fusion.c; needs fusion.yaml)\n{:<13} {}\n", kDevice, kDeviceTitle, "", kDeviceConvention);
  print(text);
}

void deliver(const ModelVerb& verb, const std::string& text) {
  if (verb.output.empty()) return print(text);
  write_whole_file(verb.output, text, verb.force);
}

void run_export(Session& session, const ModelVerb& verb) {
  const ExportTarget& target = find_export_target(verb.target);
  const ReadModels read = read_all(verb);
  const Export made = export_models(target, read.models, verb.options);
  if (!verb.json) {
    deliver(verb, made.text);
    for (const std::string& note : made.notes) session.terminal.note("note: " + printable(note));
    return;
  }
  Json document = head_of(session, "model-export", read.files);
  document["target"] = target.name;
  document["convention"] = target.convention;
  document["file"] = verb.output.empty() ? std::string(target.file) : printable(verb.output);
  document["notes"] = made.notes;
  document["text"] = made.text;
  if (!verb.output.empty()) deliver(verb, made.text);
  print(dump_json(document));
}

void run_device(Session& session, const ModelVerb& verb) {
  if (verb.files.size() != 1)
    throw usage_error("E0205", "model")
        .says("--to c takes one FILE")
        .hint("the folder of a replay, or the fusion.yaml in it");
  const LearntFusion learnt = read_fusion_file(verb.files[0]);
  const detail::DeviceSource made = detail::device_source(learnt, {verb.algorithm, verb.dtype == "f32"});
  if (!verb.output.empty() || !verb.json) deliver(verb, made.text);
  if (!verb.json) {
    for (const std::string& note : made.notes) session.terminal.note("note: " + printable(note));
    return;
  }
  Json document = head_of(session, "model-export", {document_info(learnt.file)});
  document["target"] = kDevice;
  document["convention"] = kDeviceConvention;
  document["file"] = verb.output.empty() ? std::string("fusion.c") : printable(verb.output);
  document["notes"] = made.notes;
  document["text"] = made.text;
  document["algorithm"] = made.algorithm;
  document["state_bytes"] = made.state_bytes;
  document["operations"] = made.operations;
  document["estimated_cycles"] = {{"cortex-m4f", made.cycles_m4f}, {"cortex-m33", made.cycles_m33}};
  print(dump_json(document));
}

void run_summary(const Session& session, const ModelVerb& verb) {
  const ReadModels read = read_all(verb);
  std::string text;
  if (verb.json) {
    Json document = head_of(session, "models", read.files);
    document["models"] = Json::array();
    for (const SensorModel& m : read.models) document["models"].push_back(model_json(m));
    text = dump_json(document);
  } else {
    for (const SensorModel& m : read.models)
      text += (text.empty() ? "" : "\n") + model_text(m, verb.output.empty() ? text_look() : libchar::TextLook{});
    if (verb.output.empty()) return print_text(text);
  }
  deliver(verb, text);
}

void run_model(Session& session, ModelVerb& verb) {
  if (verb.list) return print_targets(session, verb.json);
  if (verb.files.empty())
    throw usage_error("E0205", "model").says("FILE is required").hint("sensorchar model --list names the targets");
  foresee_output(verb.output, verb.files, verb.force);
  verb.options.axis = overrides(verb.places);
  if (verb.target.empty()) return run_summary(session, verb);
  if (to_device(verb)) return run_device(session, verb);
  run_export(session, verb);
}

void add_choices(VerbOptions& sub, ModelVerb& verb) {
  ExportOptions& options = verb.options;
  constexpr double kSmall = 1e-300;
  sub.add_enum("--axes", options.axes,
               "one number for three axes: the largest, their root mean square, or one axis (default: auto, one per "
               "axis if the consumer takes three, else max)");
  sub.add_texts("--axis", verb.places,
                "meaning of a channel if name and unit do not show it: gx … gz, ax … az, mx … mz; g, a, m alone for "
                "all three axes")
      .value_name("CHANNEL=PLACE")
      .one_value_each()
      .once_each();
  sub.add_number("--inflate", options.inflate, "factor on every noise number (default: 1)", kSmall);
  sub.add_number(
      "--floor-tau", options.floor_tau_s,
      "averaging time in s of the flat part of the Allan curve, for a Gauss-Markov bias (default: the model's)",
      kSmall);
  sub.add_number("--correlation-time", options.correlation_s,
                 "correlation time in s of a Gauss-Markov bias (default: floor-tau/1.8926, or ten recordings)", kSmall);
  sub.add_number("--airsim-tau", options.bias_tau_s,
                 targets_that_take(&ExportTakes::bias_tau) +
                     ": BiasStabilityTau in s (default: 500 for gyroscopes, 800 for accelerometers)",
                 kSmall);
  sub.add_number(
      "--filter-step", options.filter_step_s,
      targets_that_take(&ExportTakes::filter_step) + ": step of the filter's prediction in s (default: 0.01)", kSmall);
  sub.add_number("--gravity", options.gravity,
                 targets_that_take(&ExportTakes::gravity) + ": gravity in m/s² (default: not written)", kSmall);
  sub.add_text("--topic", options.topic,
               targets_that_take(&ExportTakes::topic) + ": ROS topic (default: that of the bag, else /imu0)")
      .value_name("NAME");
  sub.add_flag("--anyway", options.anyway, "also export coefficients with status misfit (marked)");
  sub.add_flag("--older", options.older, "basalt: one number in place of three; orbslam3: whole rate, no File.version");
}

std::vector<std::string> target_words() {
  std::vector<std::string> words;
  for (const ExportTarget& target : export_targets()) words.emplace_back(target.name);
  words.emplace_back(kDevice);
  return words;
}

/// What a target cannot write has no effect on it.
void add_only(VerbOptions& options, const ModelVerb& verb) {
  options.only("with --to", [&verb] { return !verb.target.empty() && !to_device(verb); },
               {"--axes", "--axis", "--anyway"});
  options.only("with --to c", [&verb] { return to_device(verb); }, {"--algorithm", "--dtype"});
  const auto takes = [&](bool ExportTakes::*what, const std::vector<std::string>& flags) {
    const auto taken = [&verb, what] {
      return !verb.target.empty() && !to_device(verb) && find_export_target(verb.target).takes.*what;
    };
    options.only("with --to " + targets_that_take(what), taken, flags);
  };
  takes(&ExportTakes::inflate, {"--inflate"});
  takes(&ExportTakes::gauss_markov, {"--floor-tau", "--correlation-time"});
  takes(&ExportTakes::bias_tau, {"--airsim-tau"});
  takes(&ExportTakes::filter_step, {"--filter-step"});
  takes(&ExportTakes::gravity, {"--gravity"});
  takes(&ExportTakes::topic, {"--topic"});
  takes(&ExportTakes::older, {"--older"});
}

std::function<void()> model_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<ModelVerb>();
  options.add_texts("FILE", verb->files,
                    "model files (.sensor.yaml, .json), or results of characterize (folder, report.json); the axes "
                    "of one device together. With --to c the folder of a replay or its fusion.yaml");
  options.add_text("--algorithm", verb->algorithm, "c: method of the replay (default: the recommended one)")
      .value_name("NAME");
  options.add_choice("--dtype", verb->dtype, {"f64", "f32"}, "c: double or float (default: f64)");
  options.add_text("--to", verb->target, "target; see --list").value_name("NAME").known_words(target_words());
  options.add_flag("--list", verb->list, "the targets, each with its convention").alone();
  options.add_document_output(verb->output);
  options.add_flag("--force", verb->force, "overwrite the output file");
  options.add_flag("--json", verb->json, "one JSON document instead of text");
  add_choices(options, *verb);
  add_only(options, *verb);
  return [&session, verb] { run_model(session, *verb); };
}

}  // namespace

VerbEntry verb_model() {
  return {6,
          "model",
          "Show a sensor model, or export it (--to) for Kalibr, Gazebo, VINS and others",
          model_options,
          {{"the contents of a model", "sensorchar model report/gyro_z.sensor.yaml"},
           {"the numbers of an IMU for Kalibr, from its z axes",
            "sensorchar model report --to kalibr --axes z -o imu.yaml"}}};
}

}  // namespace sensorchar

// sensorchar simulate MODEL…|SCENE -o LOG: a recording with known truth, streaming, and the scene
// that replays it.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "fault_help.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/quantity_text.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/warnings.hpp"
#include "libchar/core/whole_file.hpp"
#include "libchar/log/formats.hpp"
#include "libchar/log/read.hpp"
#include "libchar/log/write.hpp"
#include "libchar/model/model_reader.hpp"
#include "libchar/scene/fault_text.hpp"
#include "libchar/scene/scene.hpp"
#include "libchar/scene/scene_file.hpp"
#include "libchar/scene/scene_paths.hpp"
#include "libchar/scene/scene_signal.hpp"
#include "libchar/scene/scene_writer.hpp"
#include "libchar/scene/simulated_scene.hpp"
#include "libchar/simulate/sensor_array.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;
namespace fs = std::filesystem;

constexpr std::size_t kRows = std::size_t{1} << 14U;
constexpr std::uint64_t kMostDevices = 10000;

struct SimulateVerb {
  std::vector<std::string> sources;
  std::string output, scene_path, truth, temperature, endian = "little";
  std::vector<std::string> faults;
  std::optional<double> duration_s, rate_hz;
  std::uint64_t samples = 0, seed = 1, devices = 1, oversampling = 1;
  bool seed_given = false, no_truth = false, no_scene = false, no_time_column = false, json = false,
       allow_outside = false;
  WriteOptions writing;
};

[[noreturn]] void refuse_simulate(const std::string& where,
                                  const std::string& what,
                                  const std::string& got = "",
                                  const std::string& hint = "") {
  throw Error({ErrorKind::usage, "E0721", where, what, got, hint});
}

// "sine,amplitude=2,frequency_hz=0.1" as the map that a scene file would hold.
SignalSpec signal_from_words(const std::string& text, const std::string& option) {
  if (const auto value = parse_double(text)) {
    SignalSpec constant;
    constant.kind = "constant";
    constant.value = *value;
    return constant;
  }
  std::string map = "{kind: " + text.substr(0, text.find(','));
  for (std::size_t at = text.find(','); at != std::string::npos;) {
    const std::size_t end = text.find(',', at + 1);
    const std::string pair = text.substr(at + 1, end == std::string::npos ? end : end - at - 1);
    const std::size_t equals = pair.find('=');
    if (equals == std::string::npos)
      refuse_simulate(
          option, "expected KIND,key=value,…", text, "such as sine,amplitude=2,frequency_hz=0.1");
    map += ", " + pair.substr(0, equals) + ": " + pair.substr(equals + 1);
    at = end;
  }
  return read_signal(parse_yaml_document(map + "}", option), option, "");
}

// The samples of a signal that comes from a log; its path is the user's own, not a scene's.
void read_signal_samples(SignalSpec& spec,
                         const std::string& option,
                         const ArraySimulation& simulation,
                         Warnings& warnings) {
  ReadOptions reading;
  reading.hash = false;
  if (!spec.channel.empty()) reading.channels = {spec.channel};
  Recording log = read_recording(spec.file, reading);
  if (log.samples.size() != 1)
    refuse_simulate(option,
                    fmt::format("the recording holds {} channels", log.samples.size()),
                    spec.file,
                    "name one: channel=NAME");
  const double rate = log.info.time.rate_hz;
  if (rate > 0 && std::abs(rate / simulation.rate_hz - 1) > 1e-4)
    refuse_simulate(option,
                    fmt::format("the recording has {} Hz, and the simulation runs at {} Hz",
                                significant(rate, 6),
                                significant(simulation.rate_hz, 6)),
                    spec.file,
                    fmt::format("--rate {}Hz", significant(rate, 6)));
  spec.samples = std::move(log.samples[0]);
  if (spec.samples.empty()) refuse_simulate(option, "the recording holds no sample", spec.file);
  if (spec.samples.size() < simulation.samples)
    warnings.add("recorded_signal_short",
                 "a recorded signal ends before the simulation; its last sample is held",
                 option);
}

bool is_scene(const std::string& path) {
  const std::string text = read_document_text(path);
  const Document document =
      path.ends_with(".json") ? parse_json_document(text, path) : parse_yaml_document(text, path);
  const DocumentEntry* format = document.find("format");
  return format != nullptr && format->value.text == "scene";
}

std::string sensor_name(const SensorModel& model, const std::string& path) {
  if (!model.channel.empty()) return model.channel;
  std::string stem = fs::path(path).filename().string();
  return stem.substr(0, stem.find('.'));
}

// Devices of one model are numbered; equal names of several files get their number too.
void add_devices(ArraySimulation& simulation,
                 const SensorModel& model,
                 const std::string& name,
                 std::uint64_t devices) {
  std::set<std::string> taken;
  for (const SimulatedSensor& sensor : simulation.sensors) taken.insert(sensor.name);
  for (std::uint64_t i = 1; i <= devices; ++i) {
    std::string own = devices == 1 ? name : name + std::to_string(i);
    for (int again = 2; !taken.insert(own).second; ++again) own = fmt::format("{}_{}", name, again);
    simulation.sensors.push_back({own, model, {1}});
  }
}

ArraySimulation from_models(const SimulateVerb& verb) {
  ArraySimulation simulation;
  for (const std::string& path : verb.sources) {
    const SensorModel model = read_model_file(path);
    if (simulation.rate_hz == 0) simulation.rate_hz = model.rate_hz;
    if (!verb.rate_hz && model.rate_hz != simulation.rate_hz)
      refuse_simulate(
          path,
          fmt::format(
              "is a model at {} Hz and the one before at {} Hz", model.rate_hz, simulation.rate_hz),
          "",
          "give one --rate for all");
    add_devices(simulation, model, sensor_name(model, path), verb.devices);
  }
  simulation.samples = 0;
  return simulation;
}

// What the command line says on top of models or scene.
void apply_options(const SimulateVerb& verb, ArraySimulation& simulation, Warnings& warnings) {
  if (verb.rate_hz) simulation.rate_hz = *verb.rate_hz;
  if (!(simulation.rate_hz > 0))
    refuse_simulate(verb.sources[0], "states no sampling rate", "", "give --rate");
  if (simulation.rate_hz < 1e-9 || simulation.rate_hz > 1e9)
    refuse_simulate(verb.sources[0],
                    "states a sampling rate that is not between 1e-9 and 1e9 Hz",
                    significant(simulation.rate_hz, 6),
                    "give --rate");
  if (verb.samples > 0 && verb.duration_s)
    refuse_simulate("--samples", "does not go with --duration", "", "give one of them");
  if (verb.samples > 0) simulation.samples = verb.samples;
  if (verb.duration_s)
    simulation.samples =
        static_cast<std::uint64_t>(std::llround(*verb.duration_s * simulation.rate_hz));
  if (simulation.samples == 0)
    refuse_simulate("simulate", "for how long?", "", "give --duration or --samples");
  if (verb.seed_given) simulation.seed = verb.seed;
  if (verb.oversampling > 1) simulation.oversampling = verb.oversampling;
  if (!verb.truth.empty() && simulation.truth_names.size() != 1)
    refuse_simulate(
        "--truth",
        fmt::format("is one signal, and the scene has {}", simulation.truth_names.size()),
        "",
        "change them in the scene");
  if (!verb.truth.empty()) simulation.truth = {signal_from_words(verb.truth, "--truth")};
  if (!verb.temperature.empty())
    simulation.temperature = signal_from_words(verb.temperature, "--temperature");
  std::vector<std::string> names;
  for (const SimulatedSensor& sensor : simulation.sensors) names.push_back(sensor.name);
  for (const std::string& fault : verb.faults)
    simulation.faults.push_back(parse_fault(fault, names));
  const auto recorded = [&](SignalSpec& spec, const std::string& option) {
    if (spec.kind != "recording") return;
    for (const std::string& output : {verb.output, verb.scene_path})
      refuse_same_file(spec.file, output);
    read_signal_samples(spec, option, simulation, warnings);
  };
  if (!verb.truth.empty()) recorded(simulation.truth[0], "--truth");
  if (!verb.temperature.empty()) recorded(*simulation.temperature, "--temperature");
  const double end_s = static_cast<double>(simulation.samples) / simulation.rate_hz;
  for (const SensorFault& fault : simulation.faults)
    if (fault.from_s >= end_s)
      warnings.add("fault_after_end",
                   "a fault begins after the end of the recording and changes nothing",
                   fmt::format("{} from {} s, the end is at {} s",
                               simulation.sensors[fault.sensor].name,
                               significant(fault.from_s, 6),
                               significant(end_s, 6)));
}

void check_names(const ArraySimulation& simulation, const SimulateVerb& verb) {
  if (verb.no_truth || !simulation.temperature) return;
  std::vector<std::string> names = simulation.truth_names;
  for (const SimulatedSensor& sensor : simulation.sensors) names.push_back(sensor.name);
  if (std::find(names.begin(), names.end(), "temperature") != names.end())
    refuse_simulate("simulate", "a channel has the name of the temperature column", "temperature");
}

void stream(Session& session,
            const SimulateVerb& verb,
            const ArraySimulation& simulation,
            LogWriter& writer) {
  ArraySimulator simulator(simulation, 0);
  const std::size_t columns = simulation.sensors.size();
  std::uint64_t done = 0;
  for (auto block = simulator.next(kRows); !block.empty(); block = simulator.next(kRows)) {
    session.terminal.update(static_cast<double>(done) / static_cast<double>(simulation.samples),
                            "simulating");
    writer.write(verb.no_truth ? block.first(columns) : block);
    done += block[0].size();
  }
}

std::string simulation_text(const ArraySimulation& s,
                            const LogInfo& info,
                            const std::vector<DeviceDraw>& draws,
                            const std::vector<std::string>& files) {
  std::string text = fmt::format("{}: {} samples of {} channel{} at {} Hz, {} s, seed {}\n",
                                 printable(info.file),
                                 s.samples,
                                 info.channels.size(),
                                 info.channels.size() == 1 ? "" : "s",
                                 significant(s.rate_hz, 6),
                                 significant(static_cast<double>(s.samples) / s.rate_hz, 6),
                                 s.seed);
  for (std::size_t i = 0; i < s.sensors.size(); ++i) {
    const SensorModel& m = s.sensors[i].model;
    if (m.scale_factor.spread > 0 || m.bias.spread > 0)
      text += fmt::format("  {}: drew scale factor {}, bias {} {}\n",
                          printable(s.sensors[i].name),
                          significant(draws[i].scale_factor, 6),
                          significant(draws[i].bias, 6),
                          printable(m.unit));
  }
  for (std::size_t i = 1; i < files.size(); ++i)
    text += fmt::format("wrote {}\n", printable(files[i]));
  return text;
}

void run_simulate(Session& session, SimulateVerb& verb) {
  verb.writing.time_column = !verb.no_time_column;
  verb.writing.big_endian = verb.endian == "big";
  const bool scene_given = verb.sources.size() == 1 && is_scene(verb.sources[0]);
  if (verb.scene_path.empty())
    verb.scene_path = (fs::path(verb.output).replace_extension("").string() + ".scene.yaml");
  for (const std::string& source : verb.sources)
    for (const std::string& output : {verb.output, verb.scene_path})
      refuse_same_file(source, output);
  std::vector<std::string> outputs = {verb.output};
  if (!verb.no_scene) outputs.push_back(verb.scene_path);
  ArraySimulation simulation;
  Scene scene;
  if (scene_given) {
    scene = read_scene_file(verb.sources[0], {verb.allow_outside});
    session.terminal.warn(scene.warnings, scene.file);
    refuse_scene_outputs(scene, outputs);
    if (!scene.simulate)
      refuse_simulate(verb.sources[0], "is a scene of a recording, there is nothing to simulate");
    if (verb.devices > 1)
      refuse_simulate("--devices", "the scene says how many devices there are (count)");
    simulation = *scene.simulate;
  } else {
    simulation = from_models(verb);
    scene.file = verb.sources[0];
    refuse_scene_outputs(scene, outputs);
  }
  Warnings warnings;
  apply_options(verb, simulation, warnings);
  session.terminal.warn(warnings, "simulate");
  check(simulation);
  check_names(simulation, verb);
  const SimulatedRecording recording{verb.output, verb.scene_path, verb.writing, !verb.no_truth};
  const LogInfo info = log_info(simulation, recording);
  const auto writer = open_log_writer(verb.output, info, verb.writing);
  std::optional<WholeFile> scene_file;
  if (!verb.no_scene) {
    scene_file.emplace(verb.scene_path, verb.writing.overwrite);
    scene_file->write(scene_yaml(replay_scene(simulation, recording, scene)));
  }
  stream(session, verb, simulation, *writer);
  session.terminal.clear();
  session.terminal.update(1, "writing " + verb.output);  // the last chance to be stopped
  writer->finish();
  std::vector<std::string> files = writer->files();
  if (scene_file) {
    scene_file->commit();
    files.push_back(verb.scene_path);
  }
  session.terminal.clear();
  const std::vector<DeviceDraw> draws = ArraySimulator(simulation).draws();
  if (!verb.json) return print(simulation_text(simulation, info, draws, files));
  Json document = document_head(session, "simulation", {});
  document["samples"] = simulation.samples;
  document["rate_hz"] = simulation.rate_hz;
  document["seed"] = simulation.seed;
  document["output"] = Json::array();
  for (const std::string& file : files) document["output"].push_back(printable(file));
  document["sensors"] = Json::array();
  for (std::size_t i = 0; i < simulation.sensors.size(); ++i)
    document["sensors"].push_back({{"name", printable(simulation.sensors[i].name)},
                                   {"unit", printable(output_unit(simulation.sensors[i].model))},
                                   {"scale_factor", draws[i].scale_factor},
                                   {"bias", draws[i].bias}});
  document["truth"] = simulation.truth_names;
  print(dump_json(document));
}

std::function<void()> simulate_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<SimulateVerb>();
  options
      .add_texts("SOURCE",
                 verb->sources,
                 "sensor models (.sensor.yaml), one channel each, or one scene (.scene.yaml)")
      .required()
      .value_name("MODEL…|SCENE");
  options
      .add_text("-o,--output",
                verb->output,
                "log to write; its suffix says the format (" + libchar::written_suffixes() + ")")
      .required()
      .value_name("LOG");
  options.add_duration("--duration", verb->duration_s, "length of the recording (90, 90s, 1.5h)");
  options.add_count("--samples", verb->samples, "length in samples", 1);
  options.add_rate("--rate", verb->rate_hz, "sampling rate (default: the model's)");
  options.add_parsed(
      "--seed",
      "N",
      [verb](const std::string& text) {
        try {
          verb->seed = parse_count(text);
        } catch (const Error&) {
          refuse_simulate("--seed", "expected a whole number from 0 to 18446744073709551615", text);
        }
        verb->seed_given = true;
      },
      "seed of all random numbers (default: 1); the same seed gives the same samples");
  options.add_count(
      "--devices",
      verb->devices,
      "devices made from each model, each with its own scale factor, bias and noise (default: 1)",
      1,
      kMostDevices);
  options
      .add_text("--truth",
                verb->truth,
                "true input: a number, or KIND,key=value,… with KIND zero, constant, sine, chirp, "
                "noise, uniform, random_walk, ramp, or recording,file=LOG,channel=NAME; its keys "
                "are those of scenes (default: zero)")
      .value_name("SIGNAL");
  options
      .add_text("--temperature",
                verb->temperature,
                "temperature in degC, a signal as well (default: the models' reference)")
      .value_name("SIGNAL");
  options.add_texts("--fault", verb->faults, kFaultHelp).value_name("FAULT");
  options.add_count("--oversampling",
                    verb->oversampling,
                    "signals and noise are made so many times faster than the samples (default: 1)",
                    1,
                    1024);
  options.add_flag("--no-truth", verb->no_truth, "leave out the columns of the truth");
  options
      .add_text("--scene",
                verb->scene_path,
                "where the scene that replays the recording goes (default: LOG with .scene.yaml)")
      .value_name("FILE");
  options.add_flag("--no-scene", verb->no_scene, "write no scene");
  options.add_choice("--as",
                     verb->writing.format,
                     libchar::written_format_words(),
                     "format to write (default: auto, by the suffix)");
  options.add_choice("--dtype",
                     verb->writing.dtype,
                     {"f64", "f32"},
                     "npy, raw: type of the numbers (default: f64)");
  options.add_choice("--order",
                     verb->writing.order,
                     {"interleaved", "planar"},
                     "npy, raw: row by row or channel by channel (default: interleaved)");
  options.add_choice("--endian",
                     verb->endian,
                     {"little", "big"},
                     "npy, raw: order of the bytes (default: little)");
  options.add_flag(
      "--no-time-column", verb->no_time_column, "csv: leave out the first column t[s]");
  options.add_flag(
      "--allow-outside", verb->allow_outside, "the scene may name files outside its folder");
  options.add_flag("--force", verb->writing.overwrite, "overwrite existing files");
  options.add_flag("--json", verb->json, "one JSON document on stdout instead of text");
  return [&session, verb] { run_simulate(session, *verb); };
}

}  // namespace

VerbEntry verb_simulate() {
  return {7,
          "simulate",
          "A recording with known truth, from sensor models or a scene",
          simulate_options};
}

}  // namespace sensorchar

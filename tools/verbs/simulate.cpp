// sensorchar simulate MODEL…|SCENE -o LOG: a recording with known truth, streaming, and the scene that replays it.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "help/fault_help.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/quantity_text.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/formats.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/log/write.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/report/text/characterization_text.hpp"
#include "libchar/scene/scene.hpp"
#include "libchar/scene/scene_file.hpp"
#include "libchar/scene/simulated_scene.hpp"
#include "libchar/scene/text/typed_text.hpp"
#include "libchar/simulate/sensor_array.hpp"
#include "verb.hpp"
#include "writing_options.hpp"

namespace sensorchar {
namespace {

using namespace libchar;
namespace fs = std::filesystem;

constexpr std::uint64_t kMostDevices = 10000;
constexpr std::uint64_t kMostSamples = std::uint64_t{1} << 50U;

struct SimulateVerb {
  std::vector<std::string> sources;
  std::string output, scene_path, truth, temperature;
  std::vector<std::string> faults;
  std::optional<double> duration_s, rate_hz;
  std::uint64_t samples = 0, seed = 1, devices = 1, oversampling = 1;
  bool seed_given = false, no_truth = false, no_scene = false, json = false, allow_outside = false;
  bool deterministic = false;
  WritingOptions writing;
};

void set_length(const SimulateVerb& verb, ArraySimulation& simulation) {
  if (verb.rate_hz) simulation.rate_hz = *verb.rate_hz;
  if (!(simulation.rate_hz > 0))
    throw usage_error("E0721", verb.sources[0]).says("states no sampling rate").hint("give --rate");
  if (simulation.rate_hz < 1e-9 || simulation.rate_hz > 1e9)
    throw usage_error("E0721", verb.sources[0])
        .says("states a sampling rate that is not between 1 nHz and 1 GHz")
        .got(brief_text(simulation.rate_hz, 6))
        .hint("give --rate");
  if (verb.samples > 0 && verb.duration_s)
    throw usage_error("E0721", "--samples").says("does not go with --duration").hint("give one of them");
  if (verb.samples > 0) simulation.samples = std::min(verb.samples, kMostSamples);
  if (verb.duration_s)
    simulation.samples =
        clamped_whole<std::uint64_t>(std::round(*verb.duration_s * simulation.rate_hz), 0, kMostSamples);
  if (simulation.samples == 0)
    throw usage_error("E0721", "simulate").says("the length is missing").hint("give --duration or --samples");
  if (simulation.samples == kMostSamples)
    throw usage_error("E0721", verb.duration_s ? "--duration" : "--samples")
        .says("more samples than a recording can have are asked for")
        .hint("at most 1125899906842623");
}

// A file of so many samples takes two bytes for each value at least.
void refuse_beyond_disk(const SimulateVerb& verb, const ArraySimulation& simulation) {
  if (writes_through(verb.output)) return;
  std::error_code unknown;
  const fs::path folder = fs::absolute(verb.output).parent_path();
  const fs::space_info space = fs::space(folder, unknown);
  const double bytes = 2.0 * static_cast<double>(simulation.samples) * static_cast<double>(simulation.sensors.size());
  if (!unknown && bytes > static_cast<double>(space.available))
    throw output_error("E0524", verb.output)
        .says("would take {} at least, and {} are free there",
              bytes_text(clamped_whole<std::uint64_t>(bytes, 0, kMostSamples)), bytes_text(space.available))
        .hint("fewer samples, another disk, or -o - into a program");
}

// A recorded signal is read after the faults have been understood: that may take a while.
void read_recorded(const SimulateVerb& verb, SignalSpec& signal, const std::string& option,
                   const ArraySimulation& simulation, Findings& warnings) {
  if (signal.kind == "recording")
    for (const std::string& output : {verb.output, verb.scene_path}) refuse_same_file(signal.file, output);
  read_recorded_signal(signal, option, simulation, warnings);
}

// One signal is put into all sensors.
void refuse_mixed_units(const ArraySimulation& simulation) {
  const SimulatedSensor& first = simulation.sensors.front();
  for (const SimulatedSensor& other : simulation.sensors)
    if (unit_factor(first.model.unit, other.model.unit) != 1)
      throw usage_error("E0721", "--truth")
          .says("is one signal, and {} is in {}, {} in {}", printable(first.name, 40), printable(first.model.unit, 40),
                printable(other.name, 40), printable(other.model.unit, 40))
          .hint("simulate sensors of one unit together");
}

void set_signals(const SimulateVerb& verb, ArraySimulation& simulation) {
  if (!verb.truth.empty() && simulation.truth_names.size() != 1)
    throw usage_error("E0721", "--truth")
        .says("is one signal, and the scene has {}", simulation.truth_names.size())
        .hint("change them in the scene");
  if (!verb.truth.empty()) {
    refuse_mixed_units(simulation);
    simulation.truth = {parse_signal(verb.truth, "--truth")};
  }
  if (!verb.temperature.empty()) simulation.temperature = parse_signal(verb.temperature, "--temperature");
}

void add_faults(const SimulateVerb& verb, ArraySimulation& simulation) {
  std::vector<std::string> names;
  for (const SimulatedSensor& sensor : simulation.sensors) names.push_back(sensor.name);
  for (const std::string& fault : verb.faults) simulation.faults.push_back(parse_fault(fault, names));
}

// What the command line says on top of models or scene, and what was found about it.
Findings apply_options(Session& session, const SimulateVerb& verb, ArraySimulation& simulation) {
  set_length(verb, simulation);
  refuse_beyond_disk(verb, simulation);
  if (verb.seed_given) simulation.seed = verb.seed;
  if (verb.oversampling > 1) simulation.oversampling = verb.oversampling;
  simulation.deterministic = verb.deterministic;
  set_signals(verb, simulation);
  add_faults(verb, simulation);
  Findings warnings;
  if (!verb.truth.empty()) read_recorded(verb, simulation.truth[0], "--truth", simulation, warnings);
  if (!verb.temperature.empty()) read_recorded(verb, *simulation.temperature, "--temperature", simulation, warnings);
  warnings.merge(late_faults(simulation));
  session.terminal.warn(warnings, "simulate");
  return warnings;
}

// Where log and scene go; neither is an input.
void place_outputs(SimulateVerb& verb, const Scene& scene) {
  if (verb.output.empty()) throw usage_error("E0721", "--output").says("is required").hint("-o LOG");
  const bool scene_given = !verb.scene_path.empty();
  if (verb.scene_path.empty()) verb.scene_path = (fs::path(verb.output).replace_extension("").string() + ".scene.yaml");
  if (!verb.no_scene && !scene_given && writes_through(verb.output))
    throw usage_error("E0721", "--output")
        .says("a scene cannot be written next to a pipe or device")
        .got(verb.output)
        .hint("--no-scene, or --scene FILE");
  std::vector<std::string> outputs = {verb.output};
  if (!verb.no_scene) outputs.push_back(verb.scene_path);
  refuse_one_name(outputs);
  for (const std::string& source : verb.sources)
    for (const std::string& output : outputs) refuse_same_file(source, output);
  refuse_scene_outputs(scene, outputs);
  check_log_output(verb.output, write_options(verb.writing));
  if (!verb.no_scene) check_output(verb.scene_path, verb.writing.options.overwrite);
}

// The scene that `simulate` wrote beside a log makes the log again; the scene stands already.
void simulate_again(SimulateVerb& verb, Scene& scene) {
  if (!scene.simulated)
    throw usage_error("E0721", verb.sources[0]).says("is a scene of a recording, there is nothing to simulate");
  if (!scene.simulated->simulation)
    throw usage_error("E0721", verb.sources[0])
        .says("holds no simulation: an older version wrote it")
        .hint("simulate what it was made from");
  scene.simulate = std::move(scene.simulated->simulation);
  if (verb.output.empty()) verb.output = scene.recording;
  if (verb.scene_path.empty() && verb.output == scene.recording) verb.no_scene = true;
  if (!scene.simulated->truth_columns) verb.no_truth = true;
  if (scene.reading.time_column == "none") verb.writing.no_time_column = true;
  // The log is the output here, no input.
  std::erase(scene.files, scene.recording);
  scene.recording.clear();
}

// What is known of a model goes with what is simulated of it.
void report_models(Session& session, const ArraySimulation& simulation) {
  for (const SimulatedSensor& sensor : simulation.sensors) {
    std::vector<Finding> found = sensor.model.findings;
    std::erase_if(found, [](const Finding& one) { return one.severity == Severity::note; });
    report_findings(session, sensor.name, found);
  }
}

// The scene that is simulated; of models, an empty one.
Scene read_source(Session& session, SimulateVerb& verb) {
  std::vector<std::string> files;
  for (const std::string& source : verb.sources)
    for (std::string& file : model_files(source)) files.push_back(std::move(file));
  verb.sources = std::move(files);
  const bool scene_given = verb.sources.size() == 1 && is_scene_file(verb.sources[0]);
  Scene scene;
  if (scene_given) {
    scene = read_scene_file(verb.sources[0], {verb.allow_outside, true});
    session.terminal.warn(scene.warnings, scene.file);
    if (!scene.simulate) simulate_again(verb, scene);
    place_outputs(verb, scene);
    if (verb.devices > 1)
      throw usage_error("E0721", "--devices").says("the scene says how many devices there are (count)");
  } else {
    scene.simulate = simulation_of_models(verb.sources, {verb.rate_hz, verb.devices});
    report_models(session, *scene.simulate);
    scene.file = verb.sources[0];
    place_outputs(verb, scene);
  }
  return scene;
}

// argv without the program.
std::vector<std::string> words_of(const Session& session) {
  return {session.command.begin() + (session.command.empty() ? 0 : 1), session.command.end()};
}

// Beside standard output there is no place for a scene.
void take_standard_output(SimulateVerb& verb) {
  if (verb.output != "-") return;
  take_standard_output(verb.output, verb.writing, verb.json);
  if (verb.scene_path.empty()) verb.no_scene = true;
}

void run_simulate(Session& session, SimulateVerb& verb) {
  refuse_standard_output("--scene", verb.scene_path, "a scene names its recording relative to itself", "name a file");
  take_standard_output(verb);
  const Scene scene = read_source(session, verb);
  ArraySimulation simulation = *scene.simulate;
  Findings found = scene.warnings;
  found.merge(apply_options(session, verb, simulation));
  std::vector<LogInfo> read;  // before the outputs take their places
  std::vector<const LogInfo*> inputs;
  read.reserve(verb.sources.size());
  inputs.reserve(verb.sources.size());
  for (const std::string& source : verb.sources) read.push_back(document_info(source));
  read.front().warnings.merge(found);
  for (const LogInfo& one : read) inputs.push_back(&one);
  const SimulatedRecording recording{verb.output, verb.no_scene ? "" : verb.scene_path, write_options(verb.writing),
                                     !verb.no_truth, words_of(session)};
  const SimulatedLog written = simulate_log(simulation, recording, scene, session.terminal);
  session.terminal.clear();
  if (!verb.json) return print_summary(session, verb.output, simulation_text(simulation, written));
  Json document = document_head(session, "simulation", inputs);
  document.update(simulation_json(simulation, written));
  print(dump_json(document));
}

void add_length_options(VerbOptions& options, SimulateVerb& verb) {
  options.add_duration("--duration", verb.duration_s, "length of the recording (90, 90s, 1.5h)");
  options.add_count("--samples", verb.samples, "length in samples", 1);
  options.add_rate("--rate", verb.rate_hz, "sampling rate (default: the model's)");
  options.add_parsed(
      "--seed", "N",
      [&verb](const std::string& text) {
        try {
          verb.seed = parse_count(text);
        } catch (const Error&) {
          throw usage_error("E0721", "--seed").says("expected a whole number from 0 to 18446744073709551615").got(text);
        }
        verb.seed_given = true;
      },
      "seed of all random numbers (default: 1); the same seed gives the same samples");
  options.add_count("--devices", verb.devices,
                    "devices made from each model, each with its own scale factor, bias and noise (default: 1)", 1,
                    kMostDevices);
}

void add_input_options(VerbOptions& options, SimulateVerb& verb) {
  options
      .add_text("--truth", verb.truth,
                "true input: a number, or KIND,key=value,… with KIND zero, constant, sine, chirp, noise, uniform, "
                "random_walk, ramp, or recording,file=LOG,channel=NAME; its keys are those of scenes (default: zero)")
      .value_name("SIGNAL");
  options
      .add_text("--temperature", verb.temperature,
                "temperature in degC, a number or signal (default: the models' reference)")
      .value_name("SIGNAL");
  options.add_texts("--fault", verb.faults, kFaultHelp).value_name("FAULT");
  options.add_flag("--deterministic", verb.deterministic,
                   "add the steps, warm-ups and ramps of the models' recordings, at their times (default: no, they "
                   "belong to the recording, not to the sensor)");
  options.add_count("--oversampling", verb.oversampling, "oversampling factor of the simulation (default: 1)", 1, 1024);
}

std::function<void()> simulate_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<SimulateVerb>();
  options
      .add_texts("SOURCE", verb->sources,
                 "sensor models (.sensor.yaml), one channel each, or one scene (.scene.yaml); one that simulate wrote "
                 "makes its log again")
      .required()
      .value_name("MODEL…|SCENE");
  options
      .add_text("-o,--output", verb->output,
                "log to write; its suffix says the format (" + libchar::written_suffixes() +
                    "; - is standard output, without a scene); of a scene that simulate wrote its own log")
      .value_name("LOG");
  add_length_options(options, *verb);
  add_input_options(options, *verb);
  options.add_flag("--no-truth", verb->no_truth, "leave out the columns of the truth");
  const Option scene = options
                           .add_text("--scene", verb->scene_path,
                                     "file of the scene that replays the recording (default: LOG with .scene.yaml)")
                           .value_name("FILE");
  options.add_flag("--no-scene", verb->no_scene, "write no scene").excludes(scene);
  add_writing_options(options, verb->writing, "t[s]", verb->output);
  options.add_flag("--allow-outside", verb->allow_outside, "the scene may name files outside its folder");
  options.add_flag("--force", verb->writing.options.overwrite, "overwrite existing files");
  options.add_flag("--json", verb->json, "one JSON document on stdout instead of text");
  return [&session, verb] { run_simulate(session, *verb); };
}

}  // namespace

VerbEntry verb_simulate() {
  return {7,
          "simulate",
          "Simulate a recording with known truth, from sensor models or a scene",
          simulate_options,
          {{"ten minutes of a sensor at rest",
            "sensorchar simulate report/gyro_z.sensor.yaml --duration 10min -o simulated.csv"},
           {"three devices that rotate back and forth, the second with a fault",
            "sensorchar simulate report/gyro_z.sensor.yaml --devices 3 --duration 10min --truth "
            "sine,amplitude=5,frequency_hz=0.01 --fault gyro_z2:bias=0.3@200..260 -o array.csv"}}};
}

}  // namespace sensorchar

// replay SCENE -o DIR: every algorithm the scene can feed, and the report that says which to use.

#include "libchar/replay/replay.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "fault_words.hpp"
#include "heap_meter.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/whole_file.hpp"
#include "libchar/log/write.hpp"
#include "libchar/replay/algorithm_words.hpp"
#include "libchar/replay/replay_view.hpp"
#include "libchar/report/replay_html.hpp"
#include "libchar/report/replay_json.hpp"
#include "libchar/report/replay_markdown.hpp"
#include "libchar/report/replay_text.hpp"
#include "libchar/scene/scene_file.hpp"
#include "numbers.hpp"
#include "output_files.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;
namespace fs = std::filesystem;

struct ReplayVerb {
  std::string scene, folder, estimates, learning, evaluation;
  std::vector<std::string> algorithms, settings, faults;
  bool explain = false, list = false, force = false, json = false, no_allan = false,
       no_skip = false, no_faults = false, allow_outside = false;
  std::optional<double> window_s;
  std::uint64_t seed = 1;
};

[[noreturn]] void refuse(const std::string& where,
                         const std::string& what,
                         const std::string& got = "",
                         const std::string& hint = "") {
  throw Error({ErrorKind::usage, "E0910", where, what, got, hint});
}

// "0..50", "50.." in seconds.
TimeWindow window_from_words(const std::string& text, const std::string& option) {
  const std::size_t dots = text.find("..");
  if (dots == std::string::npos)
    refuse(option, "expected FROM..TO in seconds", text, "50..1000, or 50.. up to the end");
  TimeWindow window;
  try {
    if (dots > 0) window.from_s = parse_duration_s(text.substr(0, dots));
    if (dots + 2 < text.size() && text.substr(dots + 2) != "end")
      window.to_s = parse_duration_s(text.substr(dots + 2));
  } catch (const Error& error) {
    Problem problem = error.problem();
    problem.where = option;
    throw Error(problem);
  }
  if (!(window.from_s < window.to_s))
    refuse(option, "a window goes from a time to a later one", text);
  return window;
}

// "minque.gamma=0.99": an option of an algorithm that runs.
void set_option(const std::string& text, std::vector<SceneAlgorithm>& algorithms) {
  const std::size_t equals = text.find('='), dot = text.rfind('.', equals);
  const auto value =
      equals == std::string::npos ? std::nullopt : parse_double(text.substr(equals + 1));
  if (dot == std::string::npos || !value)
    refuse("--set", "expected ALGORITHM.OPTION=NUMBER", text, "--set minque.gamma=0.99");
  const std::string name = text.substr(0, dot), option = text.substr(dot + 1, equals - dot - 1);
  fusion::Settings(fusion::algorithm(name).options).set(option, *value);
  bool found = false;
  for (SceneAlgorithm& algorithm : algorithms)
    if (algorithm.name == name) {
      found = true;
      std::erase_if(algorithm.options, [&](const auto& o) { return o.first == option; });
      algorithm.options.emplace_back(option, *value);
    }
  if (!found)
    refuse("--set", "this algorithm is not among those that run", name, "--algorithms names them");
}

// What the command line says on top of the scene. Empty: the scene's list as it is.
std::vector<SceneAlgorithm> chosen(const ReplayVerb& verb, const Scene& scene) {
  std::vector<SceneAlgorithm> out;
  for (const std::string& name : verb.algorithms) {
    fusion::algorithm(name);
    out.push_back({name, {}, 0, 0});
  }
  if (verb.settings.empty()) return out;
  if (out.empty()) out = scene.algorithms;
  if (out.empty())
    for (const fusion::Entry& entry : fusion::algorithms())
      out.push_back({std::string(entry.card->name), {}, 0, 0});
  for (const std::string& setting : verb.settings) set_option(setting, out);
  return out;
}

Scene read_scene(const ReplayVerb& verb) {
  Scene scene = read_scene_file(verb.scene, {verb.allow_outside});
  if (verb.no_faults) {
    scene.faults.clear();
    if (scene.simulate) scene.simulate->faults.clear();
  }
  std::vector<std::string> names;
  for (const SceneSensor& sensor : scene.sensors) names.push_back(sensor.name);
  for (const std::string& words : verb.faults) {
    const SensorFault fault = fault_from_words(words, names);
    scene.faults.push_back(fault);
    if (scene.simulate) scene.simulate->faults.push_back(fault);
  }
  return scene;
}

// Truth and estimates as a log.
class EstimateFile final : public EstimateSink {
 public:
  EstimateFile(std::string path, bool overwrite) : path_(std::move(path)) {
    writing_.overwrite = overwrite;
  }
  void begin(const std::vector<std::string>& labels,
             const std::vector<InputResult>& inputs,
             double rate_hz,
             double start_s,
             std::uint64_t instants) override {
    LogInfo info;
    info.file = path_;
    info.samples = info.rows = instants;
    info.time.rate_hz = rate_hz;
    // Seconds from the recording's first sample, as everything else in the report.
    info.channels.push_back({"t", "s", false});
    writing_.time_column = false;
    rate_hz_ = rate_hz;
    start_s_ = start_s;
    inputs_ = inputs.size();
    labels_ = labels.size();
    for (const InputResult& input : inputs)
      info.channels.push_back({input.name, input.unit, false});
    for (const std::string& label : labels)
      for (const InputResult& input : inputs)
        info.channels.push_back(
            {inputs.size() == 1 ? label : label + " " + input.name, input.unit, false});
    writer_ = open_log_writer(path_, info, writing_);
  }
  void block(const std::vector<std::vector<double>>& columns) override {
    times_.clear();
    const std::size_t rows = columns.empty() ? 0 : columns[0].size();
    for (std::size_t k = 0; k < rows; ++k)
      times_.push_back(start_s_ + static_cast<double>(done_ + k) / rate_hz_);
    done_ += rows;
    std::vector<std::span<const double>> out = {times_};
    // Without a reference the columns of the truth are missing.
    if (columns.size() < inputs_ * (labels_ + 1)) {
      missing_.assign(columns.empty() ? 0 : columns[0].size(), kMissing);
      out.insert(out.end(), inputs_, missing_);
    }
    out.insert(out.end(), columns.begin(), columns.end());
    writer_->write(out);
  }
  std::vector<std::string> finish() {
    writer_->finish();
    return writer_->files();
  }

 private:
  std::string path_;
  WriteOptions writing_;
  std::unique_ptr<LogWriter> writer_;
  std::size_t inputs_ = 1, labels_ = 0;
  std::vector<double> missing_, times_;
  double rate_hz_ = 1, start_s_ = 0;
  std::uint64_t done_ = 0;
};

std::vector<Entry> settings_of(const ReplayVerb& verb, const ReplayResult& result) {
  std::vector<std::string> faults;
  for (const std::string& fault : verb.faults) faults.push_back(printable(fault));
  return {{"seed", verb.seed},
          {"window_s", finite_or_null(result.window_s)},
          {"allan", !verb.no_allan},
          {"no_skip", verb.no_skip},
          {"no_faults", verb.no_faults},
          {"faults", std::move(faults)}};
}

// What runs, what it needs and what can be set.
std::string list_for_people() {
  std::string text;
  for (const fusion::Entry& entry : fusion::algorithms()) {
    text += fmt::format("{:<28} {}\n", entry.card->name, entry.card->title);
    for (const std::string& need : needs_in_words(*entry.card))
      text += fmt::format("{:<28}   needs {}\n", "", need);
    for (const fusion::Option& option : entry.options)
      text += fmt::format("{:<28}   {} = {}{}  {}\n",
                          "",
                          option.name,
                          significant(option.standard, 6),
                          option.unit.empty() ? "" : " " + std::string(option.unit),
                          option.meaning);
  }
  return text;
}

// A folder that a failing run has made goes again.
struct MadeFolder {
  explicit MadeFolder(const fs::path& folder) : path(folder), old(fs::exists(folder)) {}
  MadeFolder(const MadeFolder&) = delete;
  MadeFolder& operator=(const MadeFolder&) = delete;
  ~MadeFolder() {
    std::error_code ignored;
    if (!old && fs::is_empty(path, ignored)) fs::remove(path, ignored);
  }
  fs::path path;
  bool old;
};

void run_replay(Session& session, const ReplayVerb& verb) {
  if (verb.list) return print(list_for_people());
  if (verb.scene.empty()) refuse("SCENE", "which scene?", "", "--list names the algorithms");
  const Scene scene = read_scene(verb);
  ReplayOptions options;
  options.algorithms = chosen(verb, scene);
  if (!verb.learning.empty()) options.learning = window_from_words(verb.learning, "--learning");
  if (!verb.evaluation.empty())
    options.evaluation = window_from_words(verb.evaluation, "--evaluation");
  options.window_s = verb.window_s.value_or(0);
  options.allan = !verb.no_allan;
  options.no_skip = verb.no_skip;
  options.seed = verb.seed;
  ReplayWorkspace workspace;
  workspace.heap = heap_meter();
  if (verb.explain) {
    const auto plan = explain_replay(scene, options, session.terminal);
    session.terminal.clear();
    session.terminal.warn(scene.warnings, verb.scene);
    for (const std::string& sentence : plan) print(printable(sentence) + "\n");
    return;
  }
  if (verb.folder.empty())
    refuse("-o", "where do the results go?", "", "-o DIR, or --explain for the plan alone");
  std::vector<std::string> inputs = scene.files;
  inputs.push_back(verb.scene);
  const fs::path folder = verb.folder;
  const MadeFolder made(folder);
  std::vector<std::string> files;
  for (const char* name : {"report.html", "report.json", "report.md"})
    files.push_back((folder / name).string());
  std::optional<EstimateFile> estimates;
  if (!verb.estimates.empty()) {
    const std::string path = (folder / ("estimates." + verb.estimates)).string();
    format_to_write(path, {});
    check_outputs({path}, folder, inputs, verb.force);
    estimates.emplace(path, verb.force);
    workspace.estimates = &*estimates;
  }
  check_outputs(files, folder, inputs, verb.force);
  ReplayResult result = replay(scene, options, session.terminal, workspace);
  session.terminal.clear();
  result.command = session.command;
  result.settings = settings_of(verb, result);
  session.terminal.warn(result.warnings, verb.scene);
  for (const LogInfo& log : result.logs) report_warnings(session, log);
  const ReplayView view = replay_view(result);
  const Json document = replay_json(view);
  const std::vector<OutputFile> outputs = {{files[0], replay_html(view)},
                                           {files[1], dump_json(document)},
                                           {files[2], replay_markdown(view)}};
  write_outputs(outputs, folder, inputs, verb.force, [&] {
    if (estimates)
      for (const std::string& file : estimates->finish()) files.push_back(file);
  });
  if (verb.json) return print(dump_json(document));
  print(replay_text(view));
  std::string written = "\nwrote";
  for (const std::string& file : files) written += fmt::format(" {}", printable(file));
  print(written + "\n");
}

std::function<void()> add_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<ReplayVerb>();
  options.add_text(
      "SCENE", verb->scene, "scene file (docs/scenes.md), of a recording or a simulation");
  options.add_text("-o,--output", verb->folder, "folder for the results, made when absent")
      .value_name("DIR");
  options
      .add_texts("--algorithms",
                 verb->algorithms,
                 "run these only (default: the scene's, else all it can feed)")
      .separated_by_commas()
      .value_name("NAME,…");
  options.add_texts("--set", verb->settings, "option of an algorithm, ALGORITHM.OPTION=NUMBER")
      .value_name("SETTING");
  options
      .add_text("--learning",
                verb->learning,
                "learning window FROM..TO in seconds (default: the scene's)")
      .value_name("WINDOW");
  options
      .add_text("--evaluation",
                verb->evaluation,
                "what is scored, FROM..TO in seconds (default: the scene's, else all behind the "
                "learning window)")
      .value_name("WINDOW");
  options
      .add_texts(
          "--fault", verb->faults, std::string(kFaultHelp) + "; injected on top of the scene's")
      .value_name("FAULT");
  options.add_flag("--no-faults", verb->no_faults, "leave out the faults that the scene injects");
  options.add_duration("--window",
                       verb->window_s,
                       "length of the window RMS (default: a fiftieth of the evaluation)");
  options.add_flag("--no-allan", verb->no_allan, "without the Allan deviation of each error");
  options
      .add_text("--estimates",
                verb->estimates,
                "also write truth and all estimates to DIR/estimates.FORMAT (csv, npy, f64)")
      .value_name("FORMAT");
  options.add_count("--seed", verb->seed, "seed of the bootstrap intervals (default: 1)");
  options.add_flag("--list", verb->list, "print all algorithms, what each needs and its options");
  options.add_flag("--explain",
                   verb->explain,
                   "print the plan: what would be read, learnt, run, skipped and why");
  options.add_flag("--no-skip",
                   verb->no_skip,
                   "do all work whether an output needs it or not; the numbers are the same");
  options.add_flag(
      "--allow-outside", verb->allow_outside, "the scene may name files outside its folder");
  options.add_flag("--force", verb->force, "overwrite results of an earlier run");
  options.add_flag("--json", verb->json, "print report.json to stdout instead of the table");
  return [&session, verb] { run_replay(session, *verb); };
}

}  // namespace

VerbEntry verb_replay() {
  return {8,
          "replay",
          "Every fusion algorithm a scene can feed, compared: report.html, report.json, report.md",
          add_options};
}

}  // namespace sensorchar

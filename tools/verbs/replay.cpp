// replay SCENE|LOG -o DIR: every algorithm that the data allow, and the report that says which to use.

#include "libchar/replay/replay.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "heap_meter.hpp"
#include "help/next.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/write.hpp"
#include "libchar/replay/fusion_file.hpp"
#include "libchar/replay/view/replay_view.hpp"
#include "libchar/replay/view/words.hpp"
#include "libchar/report/replay/replay_text.hpp"
#include "libchar/scene/scene_file.hpp"
#include "reading_options.hpp"
#include "replay_source.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;
namespace fs = std::filesystem;

struct ReplayVerb {
  ReplaySource source;
  std::string folder, estimates, scene_file;
  std::vector<std::string> algorithms, settings, sweeps;
  bool explain = false, list = false, force = false, json = false, no_allan = false, no_skip = false, no_timing = false,
       published = false;
  std::optional<double> window_s, budget_s;
};

// "minque.gamma=0.99": an option of an algorithm that runs.
void set_option(const std::string& text, std::vector<SceneAlgorithm>& algorithms) {
  const Sweep setting = parse_sweep(text, "--set", 1);
  const bool found = std::any_of(algorithms.begin(), algorithms.end(),
                                 [&](const auto& algorithm) { return algorithm.name == setting.algorithm; });
  if (!found)
    throw usage_error("E0910", "--set")
        .says("this algorithm is not among those that run")
        .got(setting.algorithm)
        .hint("--algorithms names them");
  algorithms = swept({setting}, algorithms);
}

// Does a setting or a sweep name it?
bool named(const ReplayVerb& verb, std::string_view algorithm) {
  const std::string front = std::string(algorithm) + ".";
  const auto of_it = [&](const std::string& text) { return text.starts_with(front); };
  return std::any_of(verb.settings.begin(), verb.settings.end(), of_it) ||
         std::any_of(verb.sweeps.begin(), verb.sweeps.end(), of_it);
}

// What the command line says on top of the scene. Empty: the scene's list as it is.
std::vector<SceneAlgorithm> chosen(const ReplayVerb& verb, const Scene& scene) {
  std::vector<SceneAlgorithm> out;
  for (const std::string& name : verb.algorithms) {
    fusion::algorithm(name);
    out.push_back({name, {}, 0, 0});
  }
  if (verb.settings.empty() && verb.sweeps.empty()) return out;
  if (out.empty()) out = scene.algorithms;
  if (out.empty())
    for (const fusion::Entry& entry : fusion::algorithms())
      if (!entry.description->as_published || verb.published || named(verb, entry.description->name))
        out.push_back({std::string(entry.description->name), {}, 0, 0});
  for (const std::string& setting : verb.settings) set_option(setting, out);
  std::vector<Sweep> sweeps;
  for (const std::string& text : verb.sweeps) sweeps.push_back(parse_sweep(text, "--sweep"));
  return swept(sweeps, out);
}

// With what the command line says on top: the scene that --write-scene writes.
Scene read_scene(const ReplayVerb& verb) {
  Scene scene = read_replay_source(verb.source, verb.scene_file);
  if (auto algorithms = chosen(verb, scene); !algorithms.empty()) scene.algorithms = std::move(algorithms);
  if (!verb.scene_file.empty()) scene.file = verb.scene_file;
  return scene;
}

std::vector<Entry> settings_of(const ReplayVerb& verb, const ReplayResult& result) {
  std::vector<std::string> faults;
  for (const std::string& fault : verb.source.faults) faults.push_back(printable(fault));
  return {{"window_s", finite_or_null(result.window_s)},
          {"allan", !verb.no_allan},
          {"budget_s", verb.budget_s.value_or(ReplayOptions().budget_s)},
          {"no_skip", verb.no_skip},
          {"no_timing", verb.no_timing},
          {"published", verb.published},
          {"no_faults", verb.source.no_faults},
          {"faults", std::move(faults)}};
}

// A folder that a failing run has made goes again.
struct MadeFolder {
  explicit MadeFolder(const fs::path& folder) : path(folder) {
    std::error_code ignored;
    old = fs::status(folder, ignored).type() != fs::file_type::not_found;
  }
  MadeFolder(const MadeFolder&) = delete;
  MadeFolder& operator=(const MadeFolder&) = delete;
  ~MadeFolder() {
    std::error_code ignored;
    if (!old && fs::is_empty(path, ignored)) fs::remove(path, ignored);
  }
  fs::path path;
  bool old = false;
};

ReplayOptions options_of(const ReplayVerb& verb) {
  ReplayOptions options;
  options.window_s = verb.window_s.value_or(0);
  options.allan = !verb.no_allan;
  options.no_skip = verb.no_skip;
  options.published = verb.published;
  options.timing = !verb.no_timing;
  if (verb.budget_s) options.budget_s = *verb.budget_s;
  return options;
}

void print_plan(Session& session, const ReplayVerb& verb, const Scene& scene, const ReplayOptions& options) {
  const auto plan = explain_replay(scene, options, session.terminal);
  session.terminal.clear();
  session.terminal.warn(scene.warnings, verb.source.path);
  if (verb.json) {
    Json document = document_head(session, "replay-plan", {});
    document["plan"] = Json::array();
    for (const std::string& sentence : plan) document["plan"].push_back(printable(sentence));
    return print(dump_json(document));
  }
  for (const std::string& sentence : plan) print_text(printable(sentence) + "\n");
}

// What is refused is refused before anything runs: an output that is an input, or that stands already.
void check_replay_outputs(const ReplayVerb& verb, const std::vector<std::string>& inputs,
                          const std::vector<std::string>& reports, const std::string& estimates) {
  if (!estimates.empty()) {
    format_to_write(estimates, {});
    check_outputs({estimates}, verb.folder, inputs, verb.force);
  }
  check_outputs(reports, verb.folder, inputs, verb.force);
}

// The scene as a file that replays to the same results.
void write_scene(const Session& session, const ReplayVerb& verb, const Scene& scene,
                 const std::vector<std::string>& inputs) {
  const fs::path folder = fs::path(verb.scene_file).parent_path();
  write_outputs({{verb.scene_file, scene_yaml(scene)}}, folder, inputs, verb.force);
  if (!verb.json) return print_beside(session, fmt::format("wrote {}\n", printable(verb.scene_file)));
  if (!verb.folder.empty()) return;  // its report is the one document
  Json document = document_head(session, "scene-written", {});
  document["scene"] = printable(verb.scene_file);
  print(dump_json(document));
}

// The replay of mended samples; the log fused by what is recommended, and that for a device; the run as a figure.
std::vector<std::string> next_after(const Session& session, const ReplayVerb& verb, const Scene& scene,
                                    const ReplayResult& result) {
  std::vector<Finding> found = result.warnings.list();
  for (const LogInfo& log : result.logs)
    for (const Finding& one : log.warnings.list()) found.push_back(one);
  std::vector<std::string> out;
  const std::string run = shell_word(verb.folder);
  if (std::string mended = mended_command(session, found, verb.folder); !mended.empty()) out.push_back(mended);
  if (!result.learnt.recommended.empty() && !scene.recording.empty() && !result.logs.empty())
    out.push_back(fmt::format("sensorchar fuse {}{} --with {} -o {}", shell_word(scene.recording),
                              reading_flags(scene.reading, result.logs[0]), run,
                              shell_word(default_folder(scene.recording, "fused") + ".csv")));
  if (std::any_of(result.algorithms.begin(), result.algorithms.end(), [](const auto& a) { return a.ran; }))
    out.push_back(fmt::format("sensorchar plot {} --kind timeline -o {}", run, shell_word(verb.folder + ".svg")));
  return out;
}

// Runs everything and writes the reports; says which files.
void run_and_report(Session& session, const ReplayVerb& verb, const Scene& scene,
                    const std::vector<std::string>& inputs) {
  const fs::path folder = verb.folder;
  const MadeFolder made(folder);
  std::vector<std::string> files;
  for (const char* name : {"report.html", "report.json", "report.md", "fusion.yaml"})
    files.push_back((folder / name).string());
  const std::string tracks = verb.estimates.empty() ? "" : (folder / ("estimates." + verb.estimates)).string();
  check_replay_outputs(verb, inputs, files, tracks);
  ReplayWorkspace workspace;
  workspace.heap = heap_meter();
  std::optional<ColumnWriter> estimates;
  if (!tracks.empty())
    workspace.estimates = &estimates.emplace(tracks, WriteOptions{.time_column = false, .overwrite = verb.force});
  ReplayResult result = replay(scene, options_of(verb), session.terminal, workspace);
  session.terminal.clear();
  result.command = session.command;
  result.settings = settings_of(verb, result);
  const std::vector<std::string> next = next_after(session, verb, scene, result);
  session.terminal.warn(result.warnings, verb.source.path);
  for (const LogInfo& log : result.logs) report_warnings(session, log);
  refuse_strict(session);
  const ReplayView view = replay_view(result);
  Json document = replay_json(view);
  std::vector<OutputFile> outputs = {{files[0], replay_html(view, next)},
                                     {files[1], ""},
                                     {files[2], replay_markdown(view)},
                                     {files[3], fusion_yaml(result.learnt)}};
  name_files(document, outputs);
  if (estimates)
    for (const std::string& file : estimates->files()) document["files"].push_back(fs::path(file).filename().string());
  outputs[1].text = dump_json(document);
  std::vector<WholeFile*> streamed;
  if (estimates) streamed = estimates->complete();
  for (const WholeFile* file : streamed) files.push_back(file->path());
  const auto removed = write_outputs(outputs, folder, inputs, verb.force, streamed);
  if (verb.json) return print(dump_json(document));
  print_beside(session, replay_text(view, table_width()));
  std::string written = "\nwrote";
  for (const std::string& file : files) written += fmt::format(" {}", printable(file));
  if (!removed.empty()) written += fmt::format("\nremoved, of an earlier run: {}", fmt::join(removed, " "));
  if (!session.terminal.quiet()) print(written + "\n");
  say_next(session, next.empty() ? "" : next.front());
}

void print_algorithms(const Session& session, bool json) {
  if (!json) return print_text(algorithms_text());
  Json document = document_head(session, "fusion-algorithms", {});
  document["algorithms"] = algorithms_json();
  print(dump_json(document));
}

std::vector<std::string> outputs_of(const ReplayVerb& verb) {
  std::vector<std::string> out = {verb.scene_file};
  for (const char* name : {"report.html", "report.json", "report.md", "fusion.yaml"})
    out.push_back((fs::path(verb.folder) / name).string());
  if (!verb.estimates.empty()) out.push_back((fs::path(verb.folder) / ("estimates." + verb.estimates)).string());
  return out;
}

void run_replay(Session& session, ReplayVerb verb) {
  if (verb.list) return print_algorithms(session, verb.json);
  if (verb.source.path.empty())
    throw usage_error("E0910", "SCENE").says("a scene or a recording is missing").hint("--list names the algorithms");
  const Scene scene = read_scene(verb);
  if (verb.explain) return print_plan(session, verb, scene, options_of(verb));
  if (verb.folder.empty() && verb.scene_file.empty()) verb.folder = default_folder(verb.source.path, "replay");
  refuse_standard_output("--output", verb.folder);
  refuse_standard_output("--write-scene", verb.scene_file, "a scene names its recording relative to itself",
                         "name a file");
  std::vector<std::string> inputs = scene.files;
  inputs.push_back(verb.source.path);
  if (!verb.scene_file.empty() && !verb.folder.empty()) refuse_one_name(outputs_of(verb));
  if (!verb.scene_file.empty())
    check_outputs({verb.scene_file}, fs::path(verb.scene_file).parent_path(), inputs, verb.force);
  if (!verb.folder.empty()) run_and_report(session, verb, scene, inputs);
  if (!verb.scene_file.empty()) write_scene(session, verb, scene, inputs);
}

std::vector<std::string> algorithm_names() {
  std::vector<std::string> names;
  for (const fusion::Entry& entry : fusion::algorithms()) names.emplace_back(entry.description->name);
  return names;
}

/// A plan writes nothing, and a scene says nothing of how it is replayed.
void add_only(VerbOptions& options, const ReplayVerb& verb) {
  const auto runs = [&verb] { return !verb.folder.empty() && !verb.explain; };
  options.only("without --explain", [&verb] { return !verb.explain; }, {"--output", "--write-scene"});
  options.only("with -o", runs, {"--estimates", "--no-timing", "--window", "--no-allan"});
  options.only("with -o or --explain", [&verb] { return !verb.folder.empty() || verb.explain; },
               {"--budget", "--no-skip"});
}

std::function<void()> replay_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<ReplayVerb>();
  add_replay_source(options, session, verb->source);
  options.add_text("-o,--output", verb->folder, "folder for the results, made when absent (default: LOG-replay)")
      .value_name("DIR")
      .writes();
  const Option algorithms =
      options
          .add_texts("--algorithms", verb->algorithms,
                     "algorithms to run (default: the scene's, else all that have the data they need)")
          .separated_by_commas()
          .once_each()
          .value_name("NAME,…")
          .known_words(algorithm_names());
  options
      .add_flag("--published", verb->published,
                "also run the algorithms exactly as published (…-published), next to the robust ones")
      .excludes(algorithms);
  options.add_texts("--set", verb->settings, "option of an algorithm, ALGORITHM.OPTION=NUMBER")
      .value_name("SETTING")
      .once_each();
  options
      .add_texts("--sweep", verb->sweeps,
                 "run an algorithm once with each value of an option, ALGORITHM.OPTION=NUMBER,… or FROM..TO; several "
                 "make a grid")
      .one_value_each()
      .value_name("SWEEP");
  options.add_duration("--window", verb->window_s, "length of the window RMS (default: a fiftieth of the evaluation)");
  options.add_instant("--budget", verb->budget_s,
                      "processor time for leave-one-out of one algorithm, counted by its declared cost; beyond it, "
                      "leave-one-out runs on stretches or not at all (default: 10 s)");
  options.add_flag("--no-allan", verb->no_allan, "omit the Allan deviation of each error");
  options
      .add_text("--estimates", verb->estimates,
                "also write truth and all estimates to DIR/estimates.FORMAT (csv, npy, f64)")
      .value_name("FORMAT");
  options.add_flag("--list", verb->list, "print all algorithms, what each needs and its options").alone();
  options.add_flag("--explain", verb->explain, "print the plan: what would be read, learnt, run, skipped and why");
  options.add_flag("--no-timing", verb->no_timing, "omit run times and memory: the same scene gives the same bytes");
  options.add_flag("--no-skip", verb->no_skip,
                   "do all work whether an output needs it or not; the numbers are the same");
  options
      .add_text("--write-scene", verb->scene_file,
                "write the settings as a scene file, which replays to the same results; without -o nothing is run")
      .writes()
      .value_name("FILE");
  options.add_flag("--force", verb->force, "overwrite results of an earlier run").writes();
  options.add_flag("--json", verb->json, "print report.json to stdout instead of the table");
  add_only(options, *verb);
  return [&session, verb] { run_replay(session, *verb); };
}

}  // namespace

VerbEntry verb_replay() {
  return {8,
          "replay",
          "Compare all fusion algorithms on a recording or a scene: report.html, report.json, report.md",
          replay_options,
          {{"every algorithm on the channels of a recording",
            "sensorchar replay array.csv --sensors 'gyro*' --reference truth --learning 0..150 -o array-replay"},
           {"what a replay of a scene would do, and what it would leave out",
            "sensorchar replay array.scene.yaml --explain"}}};
}

}  // namespace sensorchar

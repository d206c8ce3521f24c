// characterize LOG… -o DIR: everything about a recording, in files that can be shown to a colleague.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "analysis_options.hpp"
#include "help/next.hpp"
#include "libchar/characterize/characterization_view.hpp"
#include "libchar/characterize/compare/runs.hpp"
#include "libchar/characterize/compare/verification.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/characterize/limits.hpp"
#include "libchar/characterize/settings.hpp"
#include "libchar/core/file/log_files.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/formats.hpp"
#include "libchar/report/html/fleet_report.hpp"
#include "libchar/report/html/html_report.hpp"
#include "libchar/report/text/characterization_text.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;
namespace fs = std::filesystem;

struct CharacterizeVerb {
  std::vector<std::string> logs;
  std::string folder, limits;
  bool json = false, force = false, verify = false, pool = false, lot = false, no_timing = false;
  std::uint64_t seed = 1;
  AnalysisOptions analysis;
};

/// What the exit code depends on.
struct Outcome {
  bool any_fit = false, agrees = true;
  std::vector<std::string> exceeded;  ///< limits, a sentence a recording
};

fs::path folder_for(const CharacterizeVerb& verb, const std::string& log, std::set<std::string>& taken) {
  if (verb.folder.empty()) return unused_file_name_for(default_folder(log), taken);
  if (verb.logs.size() == 1) return verb.folder;
  return fs::path(verb.folder) / unused_file_name_for(libchar::stem_of_log(log), taken);
}

std::vector<std::string> inputs_of(const CharacterizeVerb& verb) {
  std::vector<std::string> inputs = verb.logs;
  if (!verb.limits.empty()) inputs.push_back(verb.limits);
  return inputs;
}

void hold_against(const NoiseLimits& limits, Characterization& result, Outcome& outcome) {
  result.settings.push_back({"limits", limits.file});
  const auto report = std::make_shared<LimitReport>(judge_limits(result, limits));
  if (report->count(LimitStatus::fail) > 0) outcome.exceeded.push_back(result.log.file + ": " + report->verdict);
  result.limits = report;
}

Characterization characterized(Session& session, const CharacterizeVerb& verb, const CharacterizeOptions& options,
                               const std::optional<NoiseLimits>& limits, const std::string& log, Outcome& outcome) {
  Characterization result = characterize(log, options, session.terminal);
  result.command = session.command;
  result.settings = settings_of(options);
  if (verb.no_timing) result.seconds = std::numeric_limits<double>::quiet_NaN();
  if (verb.verify) {
    VerifyOptions how;
    how.seed = verb.seed;
    result.settings.push_back(part_entry("verify", {{"seed", verb.seed}}));
    verify(result, options, how, session.terminal);
  }
  if (verb.pool) result.settings.push_back(part_entry("pool", {{"seed", verb.seed}}));
  session.terminal.clear();
  if (limits) hold_against(*limits, result, outcome);
  report_warnings(session, result.log);
  for (const ChannelResult& c : result.channels) {
    const Judgement judgement = judge(c);
    outcome.any_fit = outcome.any_fit || c.fit;
    outcome.agrees = outcome.agrees && !judgement.has("simulation_disagrees");
  }
  return result;
}

std::vector<std::string> paths_of(const std::vector<OutputFile>& files) {
  std::vector<std::string> out;
  for (const OutputFile& file : files) out.push_back(file.path);
  return out;
}

/// A set of more files is named by its first ones.
constexpr std::size_t kMostNamed = 24;

void say_written(const Session& session, const std::vector<std::string>& outputs,
                 const std::vector<std::string>& removed) {
  std::string written = "\nwrote";
  const std::size_t named = outputs.size() > kMostNamed ? kMostNamed - 1 : outputs.size();
  for (std::size_t k = 0; k < named; ++k) written += fmt::format(" {}", printable(outputs[k]));
  if (named < outputs.size()) written += fmt::format(" and {} more", outputs.size() - named);
  if (!removed.empty()) written += "\nremoved, of an earlier run:";
  for (const std::string& name : removed) written += fmt::format(" {}", printable(name));
  if (!session.terminal.quiet()) print(written + "\n");
}

std::string shell_words(const std::vector<std::string>& logs) {
  std::string words;
  for (const std::string& log : logs) words += (words.empty() ? "" : " ") + shell_word(log);
  return words;
}

void run_one_by_one(Session& session, const CharacterizeVerb& verb, const CharacterizeOptions& options,
                    const std::optional<NoiseLimits>& limits, Outcome& outcome) {
  std::set<std::string> taken;
  Json documents = Json::array();
  for (const std::string& log : verb.logs) {
    Characterization result = characterized(session, verb, options, limits, log, outcome);
    refuse_strict(session);
    const fs::path folder = folder_for(verb, log, taken);
    if (verb.logs.size() == 1) result.next = next_steps(session, result, folder.string());
    const CharacterizationView view = characterization_view(result);
    const std::vector<OutputFile> outputs = report_files(view, folder);
    const auto removed = write_outputs(outputs, folder, inputs_of(verb), verb.force);
    session.wrote = true;
    if (verb.json) {
      documents.push_back(json_report(view));
      continue;
    }
    print_beside(session, characterization_text(view, text_look()));
    say_written(session, paths_of(outputs), removed);
    if (!result.next.empty()) say_next(session, result.next.front());
  }
  if (!verb.json && verb.logs.size() > 1)
    say_next(session, "sensorchar characterize " + shell_words(verb.logs) + " --lot -o lot-report");
  if (verb.json) print(dump_json(verb.logs.size() == 1 ? documents[0] : documents));
}

/// The files of one folder.
struct FolderOutputs {
  fs::path folder;
  std::vector<OutputFile> files;
};

/// Nothing is written before all of it can be. What was removed from the last of them.
std::vector<std::string> write_folders(Session& session, const CharacterizeVerb& verb,
                                       const std::vector<FolderOutputs>& all) {
  const std::vector<std::string> inputs = inputs_of(verb);
  for (const FolderOutputs& one : all) check_outputs(paths_of(one.files), one.folder, inputs, verb.force);
  std::vector<std::string> removed;
  for (const FolderOutputs& one : all) {
    removed = write_outputs(one.files, one.folder, inputs, verb.force);
    session.wrote = true;
  }
  return removed;
}

/// The reports of single recordings, in folders of their own below that of the page.
std::vector<FolderOutputs> single_reports(const CharacterizeVerb& verb, const std::vector<Characterization>& results,
                                          std::vector<std::string>& folders) {
  std::set<std::string> taken;
  std::vector<FolderOutputs> all;
  for (const Characterization& result : results) {
    folders.push_back(unused_file_name_for(libchar::stem_of_log(result.log.file), taken));
    const fs::path folder = fs::path(verb.folder) / folders.back();
    all.push_back({folder, report_files(characterization_view(result), folder)});
  }
  return all;
}

std::vector<Characterization> all_characterized(Session& session, const CharacterizeVerb& verb,
                                                const CharacterizeOptions& options,
                                                const std::optional<NoiseLimits>& limits, Outcome& outcome) {
  std::vector<Characterization> results;
  for (const std::string& log : verb.logs)
    results.push_back(characterized(session, verb, options, limits, log, outcome));
  refuse_strict(session);
  return results;
}

/// What asks for caution in one of several recordings.
void report_of_runs(Session& session, const std::vector<Characterization>& results) {
  for (const Characterization& result : results) {
    std::vector<Finding> said;
    for (const ChannelResult& channel : result.channels)
      for (Finding one : judge(channel).findings) {
        if (one.severity == Severity::note) continue;
        one.subject = channel.channel.name;
        said.push_back(std::move(one));
      }
    report_findings(session, result.log.file, said, {});
  }
}

/// The limits of the data sheet hold for what the runs together say.
void run_pooled(Session& session, const CharacterizeVerb& verb, const CharacterizeOptions& options,
                const std::optional<NoiseLimits>& limits, Outcome& outcome) {
  const auto results = all_characterized(session, verb, options, std::nullopt, outcome);
  PoolOptions how;
  how.fit = options.fit;
  how.data = options.data;
  how.seed = verb.seed;
  const PooledRuns pooled = pool_runs(results, how);
  std::optional<LimitReport> judged;
  if (limits) {
    std::vector<LimitSubject> subjects;
    for (const PooledChannel& c : pooled.channels) subjects.push_back({c.channel, &c.fit});
    judged = judge_limits(subjects, *limits);
    if (judged->count(LimitStatus::fail) > 0) outcome.exceeded.push_back(judged->verdict);
  }
  RunsReport report{results, &pooled, judged ? &*judged : nullptr, {}, session.command};
  std::vector<FolderOutputs> all = single_reports(verb, results, report.folders);
  all.push_back({verb.folder, runs_files(report, verb.folder)});
  const auto removed = write_folders(session, verb, all);
  if (verb.json) return print(dump_json(runs_json(report)));
  print_beside(session, runs_text(report, text_look()));
  report_of_runs(session, results);
  say_written(session, paths_of(all.back().files), removed);
}

void run_lot(Session& session, const CharacterizeVerb& verb, const CharacterizeOptions& options,
             const std::optional<NoiseLimits>& limits, Outcome& outcome) {
  const auto results = all_characterized(session, verb, options, limits, outcome);
  std::vector<DeviceRecord> records = records_of(results, options.data);
  std::vector<std::string> folders;
  const std::vector<FolderOutputs> all = single_reports(verb, results, folders);
  for (std::size_t r = 0; r < records.size(); ++r) records[r].report = folders[r];
  FleetLotOptions how;
  if (limits) how.limits[""] = *limits;
  const FleetLot lot = fleet_lot(records, how);
  const FleetReport report{records, &lot, "", session.command, results, next_steps(verb.folder, records, lot)};
  check_outputs(fleet_report_files(verb.folder), verb.folder, inputs_of(verb), verb.force);
  write_folders(session, verb, all);
  const std::vector<std::string> files = write_fleet_report(report, verb.folder, verb.force);
  if (verb.json) return print(dump_json(fleet_json(report)));
  print_beside(session, fleet_text(report, table_width()));
  for (const Characterization& result : results)
    if (result.limits)
      print_beside(session, "\n" + printable(result.log.file) + limits_text(*result.limits, text_look()));
  say_written(session, files, {});
}

/// The files whose names are known before the logs are read.
void foresee_reports(const CharacterizeVerb& verb) {
  std::set<std::string> taken;
  const auto foresee = [&](const fs::path& folder, std::initializer_list<const char*> names) {
    std::vector<std::string> paths;
    for (const char* name : names) paths.push_back((folder / name).string());
    foresee_outputs(paths, folder, inputs_of(verb), verb.force);
  };
  for (const std::string& log : verb.logs)
    foresee(verb.pool || verb.lot ? fs::path(verb.folder) / unused_file_name_for(libchar::stem_of_log(log), taken)
                                  : folder_for(verb, log, taken),
            {"report.html", "report.json", "curves.csv"});
  if (verb.pool) foresee(verb.folder, {"runs.html", "runs.json"});
  if (verb.lot) foresee_outputs(fleet_report_files(verb.folder), verb.folder, inputs_of(verb), verb.force);
}

void refuse_outcome(const CharacterizeVerb& verb, const Outcome& outcome) {
  if (!outcome.any_fit)
    throw numeric_error("E0711", verb.logs[0]).says("no channel could be fitted; the report says why");
  if (!outcome.agrees)
    throw Refusal(ErrorKind::check, "E0713", verb.logs[0])
        .says("a simulation of the model does not agree with the recording; the report says where");
  if (!outcome.exceeded.empty())
    throw Refusal(ErrorKind::check, "E0714", verb.limits).says("{}", fmt::join(outcome.exceeded, " "));
}

void run_characterize(Session& session, CharacterizeVerb verb) {
  const CharacterizeOptions options = finish(verb.analysis);
  if (verb.folder.empty() && verb.pool) verb.folder = "runs-report";
  if (verb.folder.empty() && verb.lot) verb.folder = "lot-report";
  refuse_standard_output("--output", verb.folder);
  if (verb.pool && verb.logs.size() < 2)
    throw usage_error("E0205", "--pool").says("needs two runs of the sensor at least");
  foresee_reports(verb);
  std::optional<NoiseLimits> limits;
  if (!verb.limits.empty()) limits = read_limits_file(verb.limits);
  Outcome outcome;
  const auto run = verb.pool ? run_pooled : verb.lot ? run_lot : run_one_by_one;
  run(session, verb, options, limits, outcome);
  refuse_outcome(verb, outcome);
}

std::function<void()> characterize_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<CharacterizeVerb>();
  verb->analysis.options.ten_a_decade = true;
  options.add_texts("LOG", verb->logs, "recordings (" + readable_files() + "; - reads CSV from standard input)")
      .required();
  options
      .add_text(
          "-o,--output", verb->folder,
          "folder for the results (made when absent; with several logs one folder each inside; default: LOG-report)")
      .value_name("DIR")
      .writes();
  options.add_flag("--force", verb->force, "overwrite results of an earlier run").writes();
  options.add_flag("--json", verb->json, "print report.json to stdout instead of the tables");
  options.add_flag("--no-timing", verb->no_timing, "omit the run time: the same input and options give the same bytes");
  options.add_flag(
      "--verify", verb->verify,
      "simulate every channel from its model, characterize that, and compare (exit code 6 when they disagree)");
  options
      .add_text("--limits", verb->limits,
                "check each noise term against data-sheet limits (docs/recordings.md): pass, fail or undecided; exit "
                "code 6 when one fails")
      .value_name("FILE");
  options.add_count("--seed", verb->seed, "seed of the simulations of --verify and --pool (default: 1)");
  const Option pool =
      options.add_flag("--pool", verb->pool,
                       "the LOGs are runs of one sensor: fit one set of coefficients to all, test whether all runs "
                       "share it, and give the spread of the turn-on bias (runs.html, runs.json, models)");
  options
      .add_flag("--lot", verb->lot,
                "compare the LOGs as devices side by side, as fleet merge does: mean and spread of each term, "
                "outliers, overlaid curves (index.html, lot.json, coefficients.csv)")
      .excludes(pool);
  options.only("with --verify or --pool", [verb = verb.get()] { return verb->verify || verb->pool; }, {"--seed"});
  add_characterize_options(options, session, verb->analysis);
  return [&session, verb] { run_characterize(session, *verb); };
}

}  // namespace

VerbEntry verb_characterize() {
  return {2,
          "characterize",
          "Analyse a recording completely: report.html, report.json, curves.csv, one sensor model per channel",
          characterize_options,
          {{"everything about a recording", "sensorchar characterize imu.csv -o report"},
           {"one channel, its longest still stretch, as one document",
            "sensorchar characterize imu.csv -c gyro_z --still auto -o still --json"}}};
}

}  // namespace sensorchar

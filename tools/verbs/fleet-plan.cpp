// fleet plan MANIFEST|LOG… -o DIR: the work of many logs in units, for any engine that runs commands.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "analysis_options.hpp"
#include "help/next.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fleet/jobs.hpp"
#include "libchar/fleet/manifest.hpp"
#include "libchar/fleet/plan.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct PlanVerb {
  std::vector<std::string> inputs, sums;
  std::string folder;
  bool json = false, no_reports = false;
  FleetPlanOptions plan;
  AnalysisOptions analysis;
};

Manifest manifest_of(const PlanVerb& verb, const CharacterizeOptions& options, Terminal& terminal) {
  const bool one = verb.inputs.size() == 1;
  Manifest manifest = one && is_manifest(verb.inputs[0]) ? read_manifest(verb.inputs[0], options)
                                                         : manifest_of_logs(verb.inputs, options);
  if (verb.sums.empty()) return manifest;
  const std::size_t without = state_digests(read_sums(verb.sums), manifest);
  if (without > 0)
    terminal.note(fmt::format("{} of {} logs have no digest in {}: theirs are taken now", without,
                              manifest.devices.size(), printable(fmt::format("{}", fmt::join(verb.sums, ", ")))));
  return manifest;
}

/// Of logs that are skipped: the first few, each with its entry.
std::string unreadable_text(const Manifest& manifest, const FleetPlan& plan) {
  constexpr std::size_t kNamed = 5;
  std::string lines;
  std::size_t count = 0;
  for (std::size_t d = 0; d < plan.devices.size(); ++d) {
    const std::string& problem = plan.devices[d].problem;
    if (problem.empty() || count++ >= kNamed) continue;
    lines += fmt::format("  {}{}\n", manifest.file.empty() ? "" : printable(manifest.devices[d].where) + ": ",
                         printable(problem));
  }
  if (count == 0) return "";
  return fmt::format("{} cannot be read; the report says why:\n", plural(count, "log")) + lines +
         (count > kNamed ? fmt::format("  and {} more\n", count - kNamed) : "");
}

Json unreadable_json(const Manifest& manifest, const FleetPlan& plan) {
  Json out = Json::array();
  for (std::size_t d = 0; d < plan.devices.size(); ++d)
    if (!plan.devices[d].problem.empty())
      out.push_back(
          {{"where", manifest.devices[d].where}, {"log", plan.devices[d].log}, {"problem", plan.devices[d].problem}});
  return out;
}

/// A plan of something else in a folder that was named by mistake is noticed.
std::string replaced_text(const ReplacedPlan& replaced, std::size_t others) {
  std::string text = replaced.damaged ? std::string("replaces a plan that is damaged")
                                      : "replaces a plan of " + plural(replaced.devices, "device");
  if (others > 0)
    text += fmt::format("; {} there {} of no unit of this one", plural(others, "result"), others == 1 ? "is" : "are");
  return text + "\n";
}

void run_plan(Session& session, PlanVerb verb) {
  if (verb.folder.empty()) verb.folder = default_folder(verb.inputs.front(), "fleet");
  refuse_standard_output("--output", verb.folder);
  const CharacterizeOptions options = finish(verb.analysis);
  verb.plan.reports = !verb.no_reports;
  const auto replaced = plan_in(verb.folder);
  const Manifest manifest = manifest_of(verb, options, session.terminal);
  const FleetPlan plan = plan_fleet(manifest, verb.plan, session.terminal);
  for (const auto& [log, warnings] : plan.warned) report_warnings(session, warnings, log);
  if (session.strict && !plan.warned.empty()) return;  // nothing is written
  const std::size_t others = replaced ? results_of_others(plan, verb.folder) : 0;
  write_plan(plan, verb.folder);
  session.wrote = true;
  const FleetStatus status = fleet_status(plan, verb.folder, session.terminal);
  session.terminal.clear();
  std::size_t stated = 0;
  for (const FleetDevice& one : manifest.devices) stated += one.sha256.empty() ? 0 : 1;
  if (verb.json) {
    Json document = document_head(session, "fleet-planned", {});
    document["folder"] = verb.folder;
    document["devices"] = plan.devices.size();
    document["unreadable"] = unreadable_json(manifest, plan);
    document["stated"] = stated;
    document["units"] = plan.units.size();
    document["undivided"] = Json::array();
    for (const auto& [why, devices] : plan.undivided)
      document["undivided"].push_back({{"why", why}, {"devices", devices.size()}});
    document["done"] = status.done;
    document["seconds"] = status.seconds_left;
    if (replaced) document["replaces"] = {{"devices", replaced->devices}, {"other_results", others}};
    return print(dump_json(document));
  }
  std::string text = fmt::format("{} in {} of work; {} have a result already, the others take about {} on one core\n",
                                 plural(plan.devices.size(), "device"), plural(plan.units.size(), "unit"), status.done,
                                 duration_text(status.seconds_left));
  if (stated > 0) text += fmt::format("the digests of {} are stated: workers check them\n", plural(stated, "log"));
  text += unreadable_text(manifest, plan);
  if (replaced) text += replaced_text(*replaced, others);
  for (const auto& [why, devices] : plan.undivided)
    text += fmt::format("{} larger than {} stays one unit: {}\n",
                        devices.size() == 1 ? "1 log" : fmt::format("each of {} logs", devices.size()),
                        bytes_text(verb.plan.split_bytes), why);
  text += fmt::format("next: sensorchar fleet run {}\n", shell_word(verb.folder));
  print_beside(session, text);
}

std::function<void()> plan_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<PlanVerb>();
  verb->analysis.options.ten_a_decade = true;
  options
      .add_texts("MANIFEST|LOG", verb->inputs,
                 "a manifest of devices and their logs (YAML, JSON or CSV, docs/fleet.md), or logs, each one device "
                 "named after its file; a quoted pattern stands for its files")
      .required();
  options.add_text("-o,--output", verb->folder, "folder of the fleet: plan, tasks, results (default: MANIFEST-fleet)")
      .value_name("DIR");
  options
      .add_texts(
          "--sums", verb->sums,
          "file with digests of logs, as sha256sum prints them: the plan does not compute them; workers check them")
      .value_name("FILE")
      .one_value_each();
  options.add_flag("--json", verb->json, "print the plan as JSON");
  options.add_flag("--by-channel", verb->plan.by_channel, "one unit per channel of a log");
  options.add_flag("--no-reports", verb->no_reports,
                   "coefficients only: no page, no tables and no models of each device");
  options.add_flag("--skip-unreadable", verb->plan.skip_unreadable,
                   "skip logs that cannot be read; the report lists them");
  options.add_bytes("--split-above", verb->plan.split_bytes,
                    "logs larger than this are divided into stretches if their format allows it (default: 4GiB)");
  options.add_bytes("--stretch", verb->plan.stretch_bytes, "approximate size of a stretch (default: 1GiB)");
  add_characterize_options(options, session, verb->analysis);
  return [&session, verb] { run_plan(session, *verb); };
}

}  // namespace

VerbEntry verb_fleet_plan() {
  return {
      20,
      "fleet-plan",
      "Split many logs into jobs",
      plan_options,
      {{"all logs of a folder", "sensorchar fleet plan logs/*.npy --rate 200 -o fleet"},
       {"with digests from sha256sum", "sensorchar fleet plan logs/*.npy --rate 200 --sums logs/SHA256SUMS -o fleet"},
       {"devices, batches and limits from a manifest", "sensorchar fleet plan line7.yaml -o fleet"}}};
}

}  // namespace sensorchar

// fleet plan MANIFEST|LOG… -o DIR: the work of many logs in units, for any engine that runs commands.

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "analysis_options.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/readable.hpp"
#include "libchar/core/shell_word.hpp"
#include "libchar/core/text.hpp"
#include "libchar/fleet/plan.hpp"
#include "libchar/fleet/status.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct PlanVerb {
  std::vector<std::string> inputs;
  std::string folder;
  bool json = false, no_reports = false;
  FleetPlanOptions plan;
  AnalysisOptions analysis;
};

Manifest manifest_of(const PlanVerb& verb, const CharacterizeOptions& options) {
  const bool one = verb.inputs.size() == 1;
  return one && is_manifest(verb.inputs[0]) ? read_manifest(verb.inputs[0], options)
                                            : manifest_of_logs(verb.inputs, options);
}

void run_plan(Session& session, PlanVerb verb) {
  const CharacterizeOptions options = finish(verb.analysis);
  verb.plan.reports = !verb.no_reports;
  const FleetPlan plan = plan_fleet(manifest_of(verb, options), verb.plan, session.terminal);
  write_plan(plan, verb.folder);
  session.wrote = true;
  const FleetStatus status = fleet_status(plan, verb.folder, session.terminal);
  session.terminal.clear();
  std::size_t skipped = 0;
  for (const PlannedDevice& one : plan.devices) skipped += one.problem.empty() ? 0 : 1;
  if (verb.json) {
    Json document = document_head(session, "fleet-planned", {});
    document["folder"] = verb.folder;
    document["devices"] = plan.devices.size();
    document["unreadable"] = skipped;
    document["units"] = plan.units.size();
    document["done"] = status.done;
    document["seconds"] = status.seconds_left;
    return print(dump_json(document));
  }
  std::string text = fmt::format(
      "{} in {} of work; {} have a result already, the others take about {} on "
      "one core\n",
      plural(plan.devices.size(), "device"),
      plural(plan.units.size(), "unit"),
      status.done,
      duration_text(status.seconds_left));
  if (skipped > 0)
    text += fmt::format("{} cannot be read; the report says why\n", plural(skipped, "log"));
  text += fmt::format("next: sensorchar fleet run {}\n", shell_word(verb.folder));
  print_beside(session, text);
}

std::function<void()> plan_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<PlanVerb>();
  verb->analysis.options.ten_a_decade = true;
  options
      .add_texts("MANIFEST|LOG",
                 verb->inputs,
                 "a manifest of devices and their logs (YAML, JSON or CSV, docs/fleet.md), or "
                 "logs, each a "
                 "device called as its file is; a quoted pattern stands for its files")
      .required();
  options.add_text("-o,--output", verb->folder, "folder of the fleet: plan, tasks, results")
      .value_name("DIR")
      .required();
  options.add_flag("--json", verb->json, "print what was planned as JSON");
  options.add_flag("--by-channel", verb->plan.by_channel, "a unit for each channel of a log");
  options.add_flag("--no-reports",
                   verb->no_reports,
                   "coefficients only: no page, no tables and no models of each device");
  options.add_flag("--skip-unreadable",
                   verb->plan.skip_unreadable,
                   "plan the others where logs cannot be read; the report names those");
  options.add_bytes(
      "--split-above",
      verb->plan.split_bytes,
      "logs larger than this are divided in stretches where their format allows (default: "
      "4GiB)");
  options.add_bytes(
      "--stretch", verb->plan.stretch_bytes, "size of a stretch, about (default: 1GiB)");
  add_characterize_options(options, session, verb->analysis);
  return [&session, verb] { run_plan(session, *verb); };
}

}  // namespace

VerbEntry verb_fleet_plan() {
  return {
      20,
      "fleet-plan",
      "many logs as units of work for any engine (fleet plan|run|status|merge|export|compare)",
      plan_options,
      {{"all logs of a folder", "sensorchar fleet plan logs/*.npy --rate 200 -o fleet"},
       {"devices, batches and limits by a manifest", "sensorchar fleet plan line7.yaml -o fleet"}}};
}

}  // namespace sensorchar

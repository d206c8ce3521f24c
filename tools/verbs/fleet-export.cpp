// fleet export DIR --to slurm|snakemake|parallel: what is left of a fleet as jobs of an engine.

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fleet/jobs.hpp"
#include "libchar/fleet/plan.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct ExportVerb {
  std::string folder, engine;
  std::optional<double> job_s;
  std::uint64_t retries = 3;
  bool json = false;
  JobOptions jobs;
};

std::vector<std::string> engine_names() {
  std::vector<std::string> names;
  for (const Engine& engine : engines()) names.push_back(engine.name);
  return names;
}

void run_export(Session& session, ExportVerb verb) {
  if (verb.job_s) verb.jobs.job_s = *verb.job_s;
  verb.jobs.retries = static_cast<int>(verb.retries);
  const FleetPlan plan = read_plan(verb.folder);
  const FleetStatus status = fleet_status(plan, verb.folder, session.terminal);
  const std::vector<FleetJob> jobs = jobs_of(plan, status, verb.jobs);
  const Engine& engine =
      *std::find_if(engines().begin(), engines().end(), [&](const Engine& e) { return e.name == verb.engine; });
  export_jobs(jobs, engine, verb.folder, verb.jobs);
  session.wrote = true;
  session.terminal.clear();
  const std::string start = jobs.empty() ? ""
                                         : fmt::format("cd {} && {}", shell_word(verb.folder),
                                                       fmt::format(fmt::runtime(engine.start), engine.file));
  if (verb.json) {
    Json document = document_head(session, "fleet-export", {});
    document["engine"] = engine.name;
    document["units"] = status.missing.size();
    document["jobs"] = jobs.size();
    document["seconds"] = status.seconds_left;
    document["start"] = start;
    return print(dump_json(document));
  }
  if (jobs.empty())
    return print_beside(session,
                        "nothing is left, every unit has a result\nnext: " + merge_command({verb.folder}) + "\n");
  print_beside(session,
               fmt::format("{} left in {}, about {} on one core\nnext: {}\n", plural(status.missing.size(), "unit"),
                           plural(jobs.size(), "job"), duration_text(status.seconds_left), start));
}

std::function<void()> export_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<ExportVerb>();
  options.add_text("DIR", verb->folder, "folder of a fleet").required();
  options
      .add_choice("--to", verb->engine, engine_names(),
                  "job arrays of Slurm, a Snakefile, or commands for GNU parallel")
      .required();
  options.add_flag("--json", verb->json, "print the result as JSON");
  options.add_duration("--job", verb->job_s, "run time of a job; it gets as many units as fit (default: 60s)");
  options.add_count("--at-once", verb->jobs.at_once, "jobs at a time (default: the engine's choice)");
  options.add_count("--retries", verb->retries, "retries of a failed job (default: 3)", 0, 100);
  options.add_number("--slower", verb->jobs.slower,
                     "a worker may be this many times slower than the machine that planned (default: 3)", 1, 1000);
  options.only("where jobs have limits: slurm, snakemake", [verb] { return verb->engine != "parallel"; }, {"--slower"});
  options
      .add_text("--program", verb->jobs.program,
                "the program on the workers: its path there, or a shell command (default: sensorchar)")
      .value_name("COMMAND");
  return [&session, verb] { run_export(session, *verb); };
}

}  // namespace

VerbEntry verb_fleet_export() {
  return {24,
          "fleet-export",
          "Export the missing units of a fleet as jobs of Slurm, Snakemake or GNU parallel",
          export_options,
          {{"job arrays of ten minutes", "sensorchar fleet export fleet --to slurm --job 10min"},
           {"all cores of this machine", "sensorchar fleet export fleet --to parallel"}}};
}

}  // namespace sensorchar

// fleet run DIR|TASK…: units of a fleet, one after the other; what has a result already costs nothing.

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "libchar/core/error.hpp"
#include "libchar/core/parallel/thread_limit.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fleet/jobs.hpp"
#include "libchar/fleet/plan.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;
namespace fs = std::filesystem;

struct RunVerb {
  std::vector<std::string> inputs;
  std::uint64_t threads = 0;
  bool json = false;
};

/// A unit, and the folder that its result goes to.
struct Work {
  FleetUnit unit;
  fs::path folder;
};

/// What came of the units.
struct Counts {
  std::uint64_t done = 0, there = 0, no_result = 0;
  std::vector<Problem> again, failed;
};

void add_fleet(const std::string& folder, std::vector<Work>& work, Counts& counts) {
  FleetPlan plan = read_plan(folder);
  const auto joined = joined_stretches(plan, folder);
  for (FleetUnit& unit : plan.units)
    if (joined.contains(unit.id))
      ++counts.there;
    else
      work.push_back({std::move(unit), folder});
}

void add_work(const std::string& input, std::vector<Work>& work, Counts& counts) {
  // What is not there is no task either, but by its name.
  const bool task = fs::exists(input) || fs::path(input).extension() == ".json";
  if (fs::is_directory(input) || !task) return add_fleet(input, work, counts);
  FleetUnit unit = read_task(input);
  work.push_back({std::move(unit), fleet_of_task(input)});
}

void run_one(Session& session, const Work& one, Counts& counts) {
  try {
    const UnitRun run = run_unit(one.unit, one.folder, session.terminal);
    report_warnings(session, run.warnings, one.unit.log);
    if (run.outcome == UnitOutcome::done) ++counts.done;
    if (run.outcome == UnitOutcome::already_there) ++counts.there;
    if (run.outcome != UnitOutcome::no_result) return;
    ++counts.no_result;
    session.terminal.note("no result: " + run.problem);
  } catch (const Error& error) {
    const Problem& problem = error.problem();
    (problem.kind == ErrorKind::again ? counts.again : counts.failed).push_back(problem);
  }
}

Json problems_json(const std::vector<Problem>& problems) {
  Json out = Json::array();
  for (const Problem& problem : problems) out.push_back(one_line(problem));
  return out;
}

void say(Session& session, const RunVerb& verb, const Counts& counts) {
  session.terminal.clear();
  if (verb.json) {
    Json document = document_head(session, "fleet-run", {});
    document["done"] = counts.done;
    document["already_there"] = counts.there;
    document["no_result"] = counts.no_result;
    document["again"] = problems_json(counts.again);
    document["failed"] = problems_json(counts.failed);
    return print(dump_json(document));
  }
  std::string text =
      fmt::format("{} done, {} had a result already", plural(counts.done + counts.no_result, "unit"), counts.there);
  if (counts.no_result > 0)
    text += fmt::format("; of {} a log could not be characterized", plural(counts.no_result, "unit"));
  const std::size_t failed = counts.failed.size() + counts.again.size();
  if (failed > 0) text += fmt::format("; {} failed", plural(failed, "unit"));
  print_beside(session, text + "\n");
}

/// The first of them, and how many.
void refuse(const std::vector<Problem>& problems) {
  if (problems.empty()) return;
  Problem first = problems[0];
  if (problems.size() > 1) first.what += fmt::format(" (and {} more of the units)", problems.size() - 1);
  throw Error(first);
}

void run_run(Session& session, const RunVerb& verb) {
  try_again_where_refused();
  if (verb.threads > 0) keep_to_threads(static_cast<int>(verb.threads));
  std::vector<Work> work;
  Counts counts;
  for (const std::string& input : verb.inputs) add_work(input, work, counts);
  for (std::size_t k = 0; k < work.size(); ++k) {
    session.terminal.update(static_cast<double>(k) / static_cast<double>(work.size()), "units");
    run_one(session, work[k], counts);
    session.wrote = session.wrote || counts.done > 0;
  }
  say(session, verb, counts);
  refuse(counts.failed);
  refuse(counts.again);
}

std::function<void()> run_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<RunVerb>();
  options
      .add_texts("DIR|TASK", verb->inputs,
                 "folder of a fleet: all of its units; or single tasks of it (DIR/tasks/000001.json)")
      .required();
  options.add_count("--threads", verb->threads, "threads at most (default: one per core); results never depend on it",
                    1, 1024);
  options.add_flag("--strict", session.strict,
                   "end with exit code 3 after a warning about a log, once all units are done");
  options.add_flag("--json", verb->json, "print the result as JSON");
  return [&session, verb] { run_run(session, *verb); };
}

}  // namespace

VerbEntry verb_fleet_run() {
  return {21,
          "fleet-run",
          "Run the units of a fleet that have no result yet (exit code 75: try again later)",
          run_options,
          {{"all of a fleet, one unit after the other", "sensorchar fleet run fleet"},
           {"two of its units", "sensorchar fleet run fleet/tasks/000001.json fleet/tasks/000002.json"}}};
}

}  // namespace sensorchar

// What is left of a fleet as jobs of an engine.

#include "libchar/fleet/jobs.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>

#include "tests/fleet/fleet_folder.hpp"

using namespace libchar;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

/// Units of a second each; the last two are the joins of the first four.
FleetPlan made_plan() {
  FleetPlan plan;
  plan.devices.resize(2);
  for (std::size_t k = 0; k < 12; ++k) {
    FleetUnit unit;
    unit.id = std::string(30, 'a') + std::to_string(10 + k);
    unit.cost = {1, 100000000 + k};
    if (k < 4) unit.kind = UnitKind::stretch;
    if (k >= 10) {
      unit.kind = UnitKind::join;
      unit.parts = {plan.units[2 * (k - 10)].id, plan.units[2 * (k - 10) + 1].id};
    }
    plan.units.push_back(unit);
  }
  return plan;
}

FleetStatus nothing_done(const FleetPlan& plan) {
  FleetStatus status;
  for (std::size_t k = 0; k < plan.units.size(); ++k) status.missing.push_back(k);
  return status;
}

/// A program that writes down what it was called with.
void write_program(const fs::path& path, const fs::path& calls) {
  fs::create_directories(path.parent_path());
  test::write_file(path, fmt::format("#!/bin/sh\necho \"$@\" >> '{}'\n", calls.string()));
  fs::permissions(path, fs::perms::owner_all);
}

bool is_there(const std::string& command) {
  return std::system(fmt::format("command -v {} > /dev/null 2>&1", command).c_str()) == 0;
}

}  // namespace

TEST_CASE("every missing unit is in one job, joins come behind the jobs of their stretches") {
  const FleetPlan plan = made_plan();
  JobOptions options;
  options.job_s = 3;
  const auto jobs = jobs_of(plan, nothing_done(plan), options);
  std::multiset<std::size_t> units;
  std::set<std::string> names;
  for (const FleetJob& job : jobs) {
    units.insert(job.units.begin(), job.units.end());
    names.insert(job.name);
    for (const std::size_t j : job.after) CHECK(j < static_cast<std::size_t>(&job - jobs.data()));
  }
  CHECK(units.size() == 12);
  CHECK(std::set<std::size_t>(units.begin(), units.end()).size() == 12);
  CHECK(names.size() == jobs.size());
  CHECK(jobs.back().after == std::vector<std::size_t>{0, 1});
  CHECK(jobs[0].cost.seconds == 3);
  FleetStatus status;
  status.missing = {5};
  CHECK(jobs_of(plan, status, options).size() == 1);
  CHECK(jobs_of(plan, {}, options).empty());
}

TEST_CASE("an export has a list of tasks for each job, and the engine's own files") {
  const test::TemporaryFolder folder;
  const FleetPlan plan = made_plan();
  JobOptions options;
  options.job_s = 5;
  const auto jobs = jobs_of(plan, nothing_done(plan), options);
  for (const Engine& engine : engines()) {
    export_jobs(jobs, engine, folder.path(), options);
    INFO(engine.name);
    CHECK(fs::exists(folder / engine.file));
  }
  // Its units have no result any more: Snakemake must not take it for done.
  const fs::path done = folder / "jobs" / (jobs[0].name + ".done");
  test::write_file(done, "");
  export_jobs(jobs, engines()[0], folder.path(), options);
  CHECK_FALSE(fs::exists(done));
  std::string tasks;
  for (const FleetJob& job : jobs) tasks += test::slurp(folder / "jobs" / (job.name + ".txt"));
  for (std::size_t k = 0; k < 12; ++k) CHECK_THAT(tasks, Contains(task_file(k) + "\n"));
  const std::string slurm = test::slurp(folder / "fleet.slurm.sh");
  CHECK_THAT(slurm, Contains("--mem=151M") && Contains("--dependency=\"afterany$before\""));
  CHECK_THAT(test::slurp(folder / "fleet.slurm.element.sh"), Contains("sensorchar fleet run --quiet --threads 1"));
  CHECK_THAT(test::slurp(folder / "Snakefile"), Contains("\"mem_mb\": 151"));
}

TEST_CASE("workers call the program by a path with any letters, or by a command line") {
  const test::TemporaryFolder folder;
  const fs::path fleet = folder / "the fleet", calls = folder / "calls";
  fs::create_directories(fleet / "tasks");
  const FleetPlan plan = made_plan();
  JobOptions options;
  options.job_s = 100;
  FleetStatus status;
  status.missing = {5, 6};
  const auto jobs = jobs_of(plan, status, options);
  REQUIRE(jobs.size() == 1);
  const std::string expected = fmt::format("fleet run --quiet --threads 1 {} {}\n", task_file(5), task_file(6));
  const fs::path program = folder / "my {} 'bin' $x" / "sensor{char}";
  write_program(program, calls);
  write_program(folder / "plain" / "sensorchar", calls);
  const std::string line = fmt::format("env A=1 '{}'", (folder / "plain" / "sensorchar").string());
  const std::string slurm =
      fmt::format("cd '{}' && SLURM_ARRAY_TASK_ID=1 sh fleet.slurm.element.sh jobs/array-1.txt", fleet.string());
  const std::map<std::string, std::string> starts = {
      {"slurm", slurm},
      {"parallel", fmt::format("sh '{}/fleet.parallel.sh' 2> /dev/null", fleet.string())},
      {"snakemake", fmt::format("cd '{}' && snakemake --cores 1 > log 2>&1 || cat log jobs/*.log", fleet.string())}};
  for (const Engine& engine : engines()) {
    if (engine.name != "slurm" && !is_there(engine.name)) continue;
    for (const std::string& one : {program.string(), line}) {
      INFO(engine.name << " " << one);
      options.program = one;
      export_jobs(jobs, engine, fleet, options);
      fs::remove(calls);
      CHECK(std::system(starts.at(engine.name).c_str()) == 0);
      CHECK(test::slurp(calls) == expected);
    }
  }
  if (is_there("parallel")) {  // another machine begins in another folder
    test::write_file(folder / "ssh", fmt::format("#!/bin/bash\nshift\n[ \"$1\" = -- ] && shift\ncd '{}'\n"
                                                 "export SHELL=/bin/sh  # as sshd does\nexec bash -c \"$*\"\n",
                                                 folder.path().string()));
    fs::permissions(folder / "ssh", fs::perms::owner_all);
    export_jobs(jobs, engines()[2], fleet, options);
    fs::remove(calls);
    CHECK(std::system(fmt::format("PARALLEL_SSH='{}' sh '{}/fleet.parallel.sh' --sshlogin 1/worker 2> /dev/null",
                                  (folder / "ssh").string(), fleet.string())
                          .c_str()) == 0);
    CHECK(test::slurp(calls) == expected);
  }
  options.program = "sensorchar\nrm";
  CHECK_THROWS_WITH(export_jobs(jobs, engines()[0], fleet, options), Contains("of one line"));
}

#pragma once
// The missing units of a fleet in jobs: as many units in one as make starting it worth its while.

#include <cstdint>
#include <filesystem>
#include <string>
#include <unordered_set>
#include <vector>

#include "libchar/core/file/output_files.hpp"
#include "libchar/core/process/progress.hpp"
#include "libchar/fleet/plan.hpp"

namespace libchar {
// How far a fleet is.

struct FleetStatus {
  std::uint64_t devices = 0, units = 0;
  std::uint64_t done = 0;                  ///< units with a result
  std::uint64_t no_result = 0;             ///< of these: the log could not be characterized
  std::vector<std::size_t> missing;        ///< units without one
  std::vector<std::string> damaged;        ///< sentences: results that count as none
  std::vector<std::size_t> damaged_units;  ///< whose these are
  std::vector<std::string> unpublished;    ///< folders of workers at work, or killed
  double seconds_left = 0;                 ///< of one core, as planned
};

FleetStatus fleet_status(const FleetPlan& plan, const std::filesystem::path& folder,
                         Progress& progress = no_progress());

/// Ids of stretches whose log has been joined: their partial states are not needed any more,
/// whether they are there, count, or not.
std::unordered_set<std::string> joined_stretches(const FleetPlan& plan, const std::filesystem::path& folder);

struct JobOptions {
  double job_s = 60;                   ///< expected length of a job, at least; a longer unit is a job of its own
  std::uint64_t at_once = 0;           ///< jobs at a time; 0 = as the engine likes
  int retries = 3;                     ///< of a job that fails
  std::string program = "sensorchar";  ///< as a worker is to call it
  double slower = 3;                   ///< a worker may be this much slower than the machine that planned
};

struct FleetJob {
  std::string name;                ///< of the units in it: another job has another name
  std::vector<std::size_t> units;  ///< indices in the plan
  std::vector<std::size_t> after;  ///< jobs that hold the stretches which these join
  UnitCost cost;                   ///< sum of the times, largest memory
};

/// In the order of the plan; joins come after all other units.
std::vector<FleetJob> jobs_of(const FleetPlan& plan, const FleetStatus& status, const JobOptions& options);

/// What an engine is given, in DIR: jobs/NAME.txt with one task file per line, and its own files.
struct Engine {
  std::string name, what;  ///< "slurm"
  std::string file;        ///< that its own command takes, in DIR
  std::string start;       ///< what to type in DIR, "{}" stands for the file
  std::vector<OutputFile> (*files)(const std::vector<FleetJob>& jobs, const std::filesystem::path& folder,
                                   const JobOptions& options);
};

/// A new engine is one file in engines/ and one line here.
const std::vector<Engine>& engines();

/// Writes the jobs and the engine's files; those of an earlier export are replaced. Throws Error(output).
void export_jobs(const std::vector<FleetJob>& jobs, const Engine& engine, const std::filesystem::path& folder,
                 const JobOptions& options);

}  // namespace libchar

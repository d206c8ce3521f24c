#pragma once
// The missing units of a fleet in jobs: as many units in one as make starting it worth its while.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libchar/core/file/output_files.hpp"
#include "libchar/fleet/plan.hpp"
#include "libchar/fleet/status.hpp"

namespace libchar {

struct JobOptions {
  double job_s = 60;  ///< expected length of a job, at least; a longer unit is a job of its own
  std::uint64_t at_once = 0;           ///< jobs at a time; 0 = as the engine likes
  int retries = 3;                     ///< of a job that fails
  std::string program = "sensorchar";  ///< as a worker is to call it
  double slower = 3;  ///< a worker may be this much slower than the machine that planned
};

struct FleetJob {
  std::string name;                ///< of the units in it: another job has another name
  std::vector<std::size_t> units;  ///< indices in the plan
  std::vector<std::size_t> after;  ///< jobs that hold the stretches which these join
  UnitCost cost;                   ///< sum of the times, largest memory
};

/// In the order of the plan; joins come behind all other units.
std::vector<FleetJob> jobs_of(const FleetPlan& plan,
                              const FleetStatus& status,
                              const JobOptions& options);

/// What an engine is given, in DIR: jobs/NAME.txt with one task file per line, and its own files.
struct Engine {
  std::string name, what;  ///< "slurm"
  std::string file;        ///< that its own command takes, in DIR
  std::string start;       ///< what to type in DIR, "{}" stands for the file
  std::vector<OutputFile> (*files)(const std::vector<FleetJob>& jobs,
                                   const std::filesystem::path& folder,
                                   const JobOptions& options);
};

/// A new engine is one file in engines/ and one line here.
const std::vector<Engine>& engines();

/// Writes the jobs and the engine's files; those of an earlier export are replaced. Throws Error(output).
void export_jobs(const std::vector<FleetJob>& jobs,
                 const Engine& engine,
                 const std::filesystem::path& folder,
                 const JobOptions& options);

}  // namespace libchar

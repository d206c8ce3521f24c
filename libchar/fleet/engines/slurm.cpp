// sbatch takes at most MaxArraySize elements (1001 unless a site says otherwise) in an array:
// longer lists go as several arrays.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "libchar/fleet/engines/engine_files.hpp"

namespace libchar {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostElements = 1000;

struct Array {
  std::vector<std::string> names;
  JobLimits limits;
};

std::vector<Array> arrays_of(const std::vector<FleetJob>& jobs, const JobOptions& options) {
  std::vector<Array> out;
  for (std::size_t first = 0; first < jobs.size(); first += kMostElements) {
    const std::size_t last = std::min(jobs.size(), first + kMostElements);
    const std::vector<FleetJob> some(jobs.begin() + static_cast<std::ptrdiff_t>(first),
                                     jobs.begin() + static_cast<std::ptrdiff_t>(last));
    Array array{{}, limits_of(some, options)};
    for (const FleetJob& job : some) array.names.push_back(job.name);
    out.push_back(std::move(array));
  }
  return out;
}

std::string element_script(const JobOptions& options) {
  return fmt::format(
      R"(#!/bin/sh
# One element of an array: the jobs of a list, by its number. A job that fails (a worker killed, a full disk, exit code 75)
# is put into the queue again, {0} times at most.
job=$(sed -n "${{SLURM_ARRAY_TASK_ID}}p" "$1")
{1}code=$?
if [ "$code" -ne 0 ] && [ "$code" -ne 3 ] && [ "${{SLURM_RESTART_COUNT:-0}}" -lt {0} ]; then
  scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}" && sleep 60
fi
exit "$code"
)",
      options.retries, run_job(options, "$job"));
}

/// "id=$(sbatch …)" of an array, behind those in `after`.
std::string submit(const Array& array, const std::string& list, const JobOptions& options, bool after) {
  const std::string limit = options.at_once > 0 ? fmt::format("%{}", options.at_once) : std::string();
  return fmt::format(
      "ids=\"$ids:$(sbatch --parsable --job-name=fleet --array=1-{}{} --mem={}M --time={} --requeue "
      "{}--output=jobs/%A_%a.log \"$@\" fleet.slurm.element.sh {})\"\n",
      array.names.size(), limit, array.limits.memory_mb, array.limits.minutes,
      after ? "--dependency=\"afterany$before\" " : "", list);
}

}  // namespace

std::vector<OutputFile> slurm_files(const std::vector<FleetJob>& jobs, const fs::path& folder,
                                    const JobOptions& options) {
  std::vector<FleetJob> first, joins;
  for (const FleetJob& job : jobs) (job.after.empty() ? first : joins).push_back(job);
  std::vector<OutputFile> files;
  std::string script =
      "#!/bin/sh\n# Submits the jobs of a fleet; words after the script's name go to sbatch (--partition=…, "
      "--account=…).\nset -e\ncd \"$(dirname \"$0\")\"\nids=\n";
  std::size_t number = 0;
  const auto add = [&](const std::vector<FleetJob>& some, bool after) {
    for (const Array& array : arrays_of(some, options)) {
      const std::string list = fmt::format("jobs/array-{}.txt", ++number);
      files.push_back({(folder / list).string(), fmt::format("{}\n", fmt::join(array.names, "\n"))});
      script += submit(array, list, options, after);
    }
  };
  add(first, false);
  if (!joins.empty()) script += "before=$ids\n";
  add(joins, !first.empty());
  script += "echo \"submitted as${ids}\" | tr : ' '\n";
  files.push_back({(folder / "fleet.slurm.element.sh").string(), element_script(options)});
  files.push_back({(folder / "fleet.slurm.sh").string(), script});
  return files;
}

}  // namespace libchar

#pragma once
// The files of each engine (jobs.hpp has their list).

#include "libchar/fleet/jobs.hpp"

namespace libchar {

/// Two job arrays, the second (joins) behind the first; a job that fails is put into the queue again.
std::vector<OutputFile> slurm_files(const std::vector<FleetJob>& jobs, const std::filesystem::path& folder,
                                    const JobOptions& options);
/// A rule with the jobs as its wildcards; a job is done when its file jobs/NAME.done is there.
std::vector<OutputFile> snakemake_files(const std::vector<FleetJob>& jobs, const std::filesystem::path& folder,
                                        const JobOptions& options);
/// A list of commands, and the call of parallel with a log of the jobs that are done.
std::vector<OutputFile> parallel_files(const std::vector<FleetJob>& jobs, const std::filesystem::path& folder,
                                       const JobOptions& options);

/// `options.program` as a shell takes it: the path of a program that is there is one word, whatever
/// is in it, and leads there from any folder; all else is a command line ("apptainer exec x.sif
/// sensorchar"). Throws Error(usage) for one of several lines.
std::string command_of(const JobOptions& options);

/// "sensorchar fleet run …" of the tasks in jobs/NAME.txt; `job`: NAME as the shell takes it.
std::string run_job(const JobOptions& options, const std::string& job);

/// A script that runs one job, by its name: what an engine would read in a command (braces, quotes) it does not see.
OutputFile job_script(const std::filesystem::path& file, const JobOptions& options);

/// Largest memory of jobs in MB, and the time limit of the longest in minutes, with what a worker may be slower.
struct JobLimits {
  std::uint64_t memory_mb = 0, minutes = 0;
};
JobLimits limits_of(const std::vector<FleetJob>& jobs, const JobOptions& options);
JobLimits limits_of(const FleetJob& job, const JobOptions& options);

}  // namespace libchar

#include <fmt/format.h>

#include "libchar/fleet/engines/engine_files.hpp"

namespace libchar {
namespace {

constexpr const char* kSnakemakeJob = "fleet.snakemake.job.sh";

std::string python_list(const std::vector<std::string>& words) {
  std::string out = "[";
  for (const std::string& word : words) out += fmt::format("{}\"{}\"", out == "[" ? "" : ", ", word);
  return out + "]";
}

std::string job_row(const std::vector<FleetJob>& jobs, const FleetJob& job, const JobOptions& options) {
  std::vector<std::string> after;
  for (const std::size_t j : job.after) after.push_back(jobs[j].name);
  const JobLimits limits = limits_of(job, options);
  return fmt::format("    \"{}\": {{\"after\": {}, \"mem_mb\": {}, \"runtime\": {}}},\n", job.name, python_list(after),
                     limits.memory_mb, limits.minutes);
}

}  // namespace

std::vector<OutputFile> snakemake_files(const std::vector<FleetJob>& jobs, const std::filesystem::path& folder,
                                        const JobOptions& options) {
  std::string text =
      "# The jobs of a fleet. A job is done when jobs/NAME.done is there; units that have a result cost nothing when "
      "it runs again.\n"
      "JOBS = {\n";
  for (const FleetJob& job : jobs) text += job_row(jobs, job, options);
  text += fmt::format(R"(}}

rule all:
    input:
        expand("jobs/{{job}}.done", job=JOBS),

rule job:
    input:
        tasks="jobs/{{job}}.txt",
        after=lambda wildcards: expand("jobs/{{after}}.done", after=JOBS[wildcards.job]["after"]),
    output:
        touch("jobs/{{job}}.done"),
    log:
        "jobs/{{job}}.log",
    threads: 1
    retries: {0}
    resources:
        mem_mb=lambda wildcards: JOBS[wildcards.job]["mem_mb"],
        runtime=lambda wildcards: JOBS[wildcards.job]["runtime"],
    shell:
        "sh {1} {{wildcards.job}} > {{log}} 2>&1"
)",
                      options.retries, kSnakemakeJob);
  return {job_script(folder / kSnakemakeJob, options), {(folder / "Snakefile").string(), text}};
}

}  // namespace libchar

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fleet/engines/engine_files.hpp"

namespace libchar {

const std::vector<Engine>& engines() {
  static const std::vector<Engine> all = {
      {"slurm", "job arrays of Slurm", "fleet.slurm.sh", "sh {}", slurm_files},
      {"snakemake", "rules of Snakemake", "Snakefile", "snakemake --cores all", snakemake_files},
      {"parallel", "commands for GNU parallel", "fleet.parallel.sh", "sh {}", parallel_files},
  };
  return all;
}

JobLimits limits_of(const FleetJob& job, const JobOptions& options) {
  constexpr double kStart_s = 60;      // a node that loads the program over a network
  constexpr double kMoreMemory = 1.5;  // a plan is no measurement
  return {clamped_whole<std::uint64_t>(std::ceil(kMoreMemory * static_cast<double>(job.cost.memory_bytes) / 1e6)),
          clamped_whole<std::uint64_t>(std::ceil((kStart_s + options.slower * job.cost.seconds) / 60))};
}

JobLimits limits_of(const std::vector<FleetJob>& jobs, const JobOptions& options) {
  JobLimits out;
  for (const FleetJob& job : jobs) {
    const JobLimits one = limits_of(job, options);
    out.memory_mb = std::max(out.memory_mb, one.memory_mb);
    out.minutes = std::max(out.minutes, one.minutes);
  }
  return out;
}

namespace fs = std::filesystem;

std::string command_of(const JobOptions& options) {
  const std::string& program = options.program;
  const bool one_line =
      std::none_of(program.begin(), program.end(), [](unsigned char c) { return c < ' ' && c != '\t'; });
  if (program.find_first_not_of(" \t") == std::string::npos || !one_line)
    throw usage_error("E0205", "`program`").says("expected a program or a command of one line").got(program);
  std::error_code ignored;
  // Without a slash a shell seeks it in its PATH, not here.
  const bool path = program.find('/') != std::string::npos;
  if (!path || !fs::is_regular_file(program, ignored)) return program;
  return shell_word(fs::absolute(program).lexically_normal().string());
}

std::string run_job(const JobOptions& options, const std::string& job) {
  return fmt::format("{} fleet run --quiet --threads 1 $(cat \"jobs/{}.txt\")\n", command_of(options), job);
}

OutputFile job_script(const fs::path& file, const JobOptions& options) {
  return {file.string(), "#!/bin/sh\n# Runs the units of one job, by its name.\n" + run_job(options, "$1")};
}

}  // namespace libchar

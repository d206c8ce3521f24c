#include <fmt/format.h>

#include "libchar/fleet/engines/engine_files.hpp"

namespace libchar {
namespace {

constexpr const char* kParallelJob = "fleet.parallel.job.sh";

std::string call(const std::string& list, const JobOptions& options) {
  return fmt::format("parallel --wd \"$PWD\" --jobs {} --retries {} {} \"$@\" sh {} < {}\n",
                     options.at_once > 0 ? std::to_string(options.at_once) : "100%", options.retries + 1,
                     "--memfree 64M", kParallelJob, list);
}

}  // namespace

std::vector<OutputFile> parallel_files(const std::vector<FleetJob>& jobs, const std::filesystem::path& folder,
                                       const JobOptions& options) {
  std::string first, joins;
  for (const FleetJob& job : jobs) (job.after.empty() ? first : joins) += job.name + "\n";
  std::string script =
      "#!/bin/sh\n# Runs the jobs of a fleet on this machine; words after the script's name go to parallel "
      "(--sshlogin …: this folder and the\n# logs have the same paths there).\ncd \"$(dirname \"$0\")\" || exit\n";
  std::vector<OutputFile> files;
  const auto add = [&](const std::string& names, const char* list) {
    if (names.empty()) return;
    files.push_back({(folder / list).string(), names});
    script += call(list, options);
  };
  add(first, "jobs/list-1.txt");
  add(joins, "jobs/list-2.txt");
  files.push_back(job_script(folder / kParallelJob, options));
  files.push_back({(folder / "fleet.parallel.sh").string(), script});
  return files;
}

}  // namespace libchar

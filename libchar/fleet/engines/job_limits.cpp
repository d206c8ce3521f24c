#include <algorithm>
#include <cmath>

#include "libchar/fleet/engines/engine_files.hpp"

namespace libchar {

JobLimits limits_of(const FleetJob& job, const JobOptions& options) {
  constexpr double kStart_s = 60;      // a node that loads the program over a network
  constexpr double kMoreMemory = 1.5;  // a plan is no measurement
  return {
      static_cast<std::uint64_t>(
          std::ceil(kMoreMemory * static_cast<double>(job.cost.memory_bytes) / 1e6)),
      static_cast<std::uint64_t>(std::ceil((kStart_s + options.slower * job.cost.seconds) / 60))};
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

}  // namespace libchar

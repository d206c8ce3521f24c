#include "libchar/fleet/jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "libchar/core/file/sha256.hpp"
#include "libchar/fleet/detail/result_store.hpp"

namespace libchar {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kNameDigits = 12;

std::string name_of_job(const FleetPlan& plan, const FleetJob& job) {
  Sha256 hash;
  for (const std::size_t k : job.units) hash.update(task_file(k) + plan.units[k].id + "\n");
  return hash.finish().substr(0, kNameDigits);
}

class JobMaker {
 public:
  JobMaker(const FleetPlan& plan, const JobOptions& options, std::vector<FleetJob>& jobs)
      : plan_(plan), options_(options), jobs_(jobs) {}
  ~JobMaker() { close(); }

  void add(std::size_t k) {
    const UnitCost& cost = plan_.units[k].cost;
    open_.units.push_back(k);
    open_.cost.seconds += cost.seconds;
    open_.cost.memory_bytes = std::max(open_.cost.memory_bytes, cost.memory_bytes);
    if (open_.cost.seconds >= options_.job_s) close();
  }
  void close() {
    if (open_.units.empty()) return;
    open_.name = name_of_job(plan_, open_);
    jobs_.push_back(std::move(open_));
    open_ = {};
  }

 private:
  const FleetPlan& plan_;
  const JobOptions& options_;
  std::vector<FleetJob>& jobs_;
  FleetJob open_;
};

/// Which job makes the parts of the joins in `job`.
void add_after(const FleetPlan& plan,
               const std::map<std::string, std::size_t>& job_of_id,
               FleetJob& job) {
  for (const std::size_t k : job.units)
    for (const std::string& part : plan.units[k].parts)
      if (const auto at = job_of_id.find(part); at != job_of_id.end())
        job.after.push_back(at->second);
  std::sort(job.after.begin(), job.after.end());
  job.after.erase(std::unique(job.after.begin(), job.after.end()), job.after.end());
}

}  // namespace

std::vector<FleetJob> jobs_of(const FleetPlan& plan,
                              const FleetStatus& status,
                              const JobOptions& options) {
  std::vector<FleetJob> jobs;
  for (const bool joins : {false, true}) {
    JobMaker maker(plan, options, jobs);
    for (const std::size_t k : status.missing)
      if ((plan.units[k].kind == UnitKind::join) == joins) maker.add(k);
  }
  std::map<std::string, std::size_t> job_of_id;
  for (std::size_t j = 0; j < jobs.size(); ++j)
    for (const std::size_t k : jobs[j].units) job_of_id[plan.units[k].id] = j;
  for (FleetJob& job : jobs) add_after(plan, job_of_id, job);
  return jobs;
}

void export_jobs(const std::vector<FleetJob>& jobs,
                 const Engine& engine,
                 const fs::path& folder,
                 const JobOptions& options) {
  make_fleet_folder(folder / "jobs");
  for (const FleetJob& job : jobs) {
    std::string lines;
    for (const std::size_t k : job.units) lines += task_file(k) + "\n";
    write_whole_file((folder / "jobs" / (job.name + ".txt")).string(), lines, true);
    // Of an earlier time: its results were lost or damaged since.
    std::error_code ignored;
    fs::remove(folder / "jobs" / (job.name + ".done"), ignored);
  }
  for (const OutputFile& file : engine.files(jobs, folder, options))
    write_whole_file(file.path, file.text, true);
}

}  // namespace libchar

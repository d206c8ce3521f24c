#include "libchar/fleet/jobs.hpp"

#include <algorithm>
#include <map>

#include "libchar/core/error.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/fleet/detail/log_seen.hpp"
#include "libchar/fleet/detail/result_store.hpp"

namespace libchar {
namespace {

enum class Found { nothing, result, no_result };

Found look_at(const FleetUnit& unit, const std::filesystem::path& folder) {
  if (unit.kind == UnitKind::stretch)
    return !stored_states(folder, unit.id).empty() && result_counts(folder, unit) ? Found::result : Found::nothing;
  const auto record = stored_record(folder, unit.id);
  if (!record || !result_counts(folder, unit)) return Found::nothing;
  const bool any = record->problem.empty() && why_nothing_fitted(*record).empty();
  return any ? Found::result : Found::no_result;
}

}  // namespace

std::unordered_set<std::string> joined_stretches(const FleetPlan& plan, const std::filesystem::path& folder) {
  std::unordered_set<std::string> out;
  for (const FleetUnit& unit : plan.units)
    if (unit.kind == UnitKind::join && has_result(folder, unit.id, false))
      out.insert(unit.parts.begin(), unit.parts.end());
  return out;
}

FleetStatus fleet_status(const FleetPlan& plan, const std::filesystem::path& folder, Progress& progress) {
  FleetStatus out;
  out.devices = plan.devices.size();
  out.units = plan.units.size();
  const std::unordered_set<std::string> joined = joined_stretches(plan, folder);
  for (std::size_t k = 0; k < plan.units.size(); ++k) {
    if (k % 256 == 0) progress.update(static_cast<double>(k) / static_cast<double>(out.units), "looking at results");
    const FleetUnit& unit = plan.units[k];
    Found found = Found::nothing;
    try {
      found = joined.contains(unit.id) ? Found::result : look_at(unit, folder);
    } catch (const Error& error) {
      out.damaged.push_back(one_line(error.problem()));
      out.damaged_units.push_back(k);
    }
    if (found == Found::nothing) {
      out.missing.push_back(k);
      out.seconds_left += unit.cost.seconds;
    } else {
      ++out.done;
      if (found == Found::no_result) ++out.no_result;
    }
  }
  out.unpublished = unpublished(folder);
  return out;
}

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
void add_after(const FleetPlan& plan, const std::map<std::string, std::size_t>& job_of_id, FleetJob& job) {
  for (const std::size_t k : job.units)
    for (const std::string& part : plan.units[k].parts)
      if (const auto at = job_of_id.find(part); at != job_of_id.end()) job.after.push_back(at->second);
  std::sort(job.after.begin(), job.after.end());
  job.after.erase(std::unique(job.after.begin(), job.after.end()), job.after.end());
}

}  // namespace

std::vector<FleetJob> jobs_of(const FleetPlan& plan, const FleetStatus& status, const JobOptions& options) {
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

void export_jobs(const std::vector<FleetJob>& jobs, const Engine& engine, const fs::path& folder,
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
  for (const OutputFile& file : engine.files(jobs, folder, options)) write_whole_file(file.path, file.text, true);
}

}  // namespace libchar

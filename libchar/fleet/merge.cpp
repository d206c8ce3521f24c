#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fleet/detail/log_seen.hpp"
#include "libchar/fleet/detail/result_store.hpp"
#include "libchar/fleet/plan.hpp"

namespace libchar {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNotThere = "its result is not there yet";

/// Units that have no result, and what was wrong with those that are damaged.
struct Missing {
  std::vector<std::size_t> units;
  std::vector<std::string> damaged;
};

void refuse_missing(const FleetPlan& plan, const Missing& missing, const fs::path& folder) {
  if (missing.units.empty()) return;
  const FleetUnit& first = plan.units[missing.units[0]];
  throw input_error("E0789", folder.string())
      .says("{} of {} units have no result, the first is {} of {}{}", missing.units.size(), plan.units.size(),
            task_file(missing.units[0]), plan.devices[first.device].device,
            missing.damaged.empty() ? "" : "; " + missing.damaged[0])
      .hint("run them with: sensorchar fleet run {}, or merge what there is with `partial`", folder.string());
}

/// What the plan says of the device, over what its log said.
void name_device(const PlannedDevice& planned, DeviceRecord& record) {
  record.device = planned.device;
  record.type = planned.type;
  record.batch = planned.batch;
  record.temperature_c = planned.temperature_c;
  record.log = planned.log;
  record.sha256 = planned.sha256;
}

std::string report_of(const FleetUnit& unit, const fs::path& folder, const fs::path& relative_to) {
  if (!unit.reports) return "";
  const fs::path report = fs::absolute(folder) / "results" / result_folder(unit.id);
  std::error_code ignored;
  if (!fs::exists(report / "report.html", ignored)) return "";  // no link that leads nowhere
  return relative_to.empty()
             ? report.lexically_normal().string()
             : report.lexically_normal().lexically_relative(fs::absolute(relative_to).lexically_normal()).string();
}

/// An id of each options that a plan has: units share them. Those of one channel may come from
/// unlike lists of whole logs.
class OptionIds {
 public:
  explicit OptionIds(std::string (*id)(const FleetUnit&)) : id_(id) {}
  const std::string& of(const FleetUnit& unit) {
    std::string& known = known_[{unit.options.get(), unit.settings}];
    if (known.empty()) known = id_(unit);
    return known;
  }

 private:
  std::string (*id_)(const FleetUnit&);
  std::map<std::pair<const CharacterizeOptions*, std::string>, std::string> known_;
};

/// Channels of one log that were units of their own stand together again.
void add_result(const PlannedDevice& planned, const DeviceRecord& found, DeviceRecord& record) {
  // What a thermometer in the log says counts where the plan says nothing.
  if (!planned.temperature_c && found.temperature_c) record.temperature_c = found.temperature_c;
  record.program = found.program;
  record.settings = found.settings;
  if (!found.problem.empty() && (record.problem.empty() || record.awaited)) {
    record.problem = found.problem;
    record.awaited = false;
  }
  for (const Finding& one : found.findings)
    if (std::find(record.findings.begin(), record.findings.end(), one) == record.findings.end())
      record.findings.push_back(one);
  record.channels.insert(record.channels.end(), found.channels.begin(), found.channels.end());
}

/// What of a log a unit has, and whose it is.
struct LogPart {
  std::size_t fleet = 0, device = 0;
  std::vector<std::string> channels;  ///< empty: all
};

bool overlap(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  return a.empty() || b.empty() || std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
}

[[noreturn]] void refuse_common(const std::vector<PlannedFleet>& fleets, const LogPart& one, const LogPart& other) {
  const auto name = [&](const LogPart& part) {
    const PlannedFleet& fleet = fleets[part.fleet];
    return fmt::format("{} in {}", printable(fleet.plan.devices[part.device].device), printable(fleet.folder.string()));
  };
  const PlannedFleet& fleet = fleets[other.fleet];
  throw input_error("E0783", fleet.folder.string())
      .says("the logs of {} and {} are the same, byte by byte", name(one), name(other))
      .got(fleet.plan.devices[other.device].log)
      .hint("leave one of the fleets out, or plan it without that log: it would count twice");
}

}  // namespace

std::vector<PlannedFleet> read_fleets(const std::vector<std::string>& folders) {
  std::vector<std::string> sorted = folders;
  const auto whole = [](const std::string& folder) {
    std::error_code ignored;
    const fs::path path = fs::weakly_canonical(folder, ignored);
    return path.has_filename() ? path : path.parent_path();
  };
  std::sort(sorted.begin(), sorted.end(),
            [&](const std::string& a, const std::string& b) { return whole(a) < whole(b); });
  std::vector<PlannedFleet> out;
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    if (k > 0 && whole(sorted[k]) == whole(sorted[k - 1]))
      throw usage_error("E0795", sorted[k])
          .says("this fleet is named twice")
          .hint("name each folder once: its devices would count twice");
    out.push_back({sorted[k], read_plan(sorted[k])});
  }
  return out;
}

void refuse_common_logs(const std::vector<PlannedFleet>& fleets) {
  if (fleets.size() < 2) return;
  std::unordered_multimap<std::string, LogPart> known;
  OptionIds settings(settings_id);
  for (std::size_t f = 0; f < fleets.size(); ++f)
    for (const FleetUnit& unit : fleets[f].plan.units) {
      if (unit.kind == UnitKind::stretch) continue;
      const LogPart part{f, unit.device, unit.options->reading.channels};
      const std::string key = unit.sha256 + settings.of(unit);
      const auto [begin, end] = known.equal_range(key);
      for (auto at = begin; at != end; ++at)
        if (at->second.fleet != f && overlap(at->second.channels, part.channels))
          refuse_common(fleets, at->second, part);
      known.emplace(key, part);
    }
}

std::string merge_command(const std::vector<std::string>& folders) {
  std::string out = "sensorchar fleet merge";
  bool here = false;
  for (const std::string& folder : folders) {
    std::error_code ignored;
    here = here || fs::equivalent(folder, ".", ignored);
    out += " " + shell_word(folder);
  }
  return out + (here ? " -o ../report" : " -o report");
}

std::vector<DeviceRecord> merged_records(const FleetPlan& plan, const fs::path& folder, const MergeOptions& options,
                                         Progress& progress) {
  std::vector<DeviceRecord> out(plan.devices.size());
  for (std::size_t d = 0; d < out.size(); ++d) {
    out[d].problem = plan.devices[d].problem;
    name_device(plan.devices[d], out[d]);
  }
  Missing missing;
  OptionIds analyses(analysis_id);
  for (std::size_t k = 0; k < plan.units.size(); ++k) {
    const FleetUnit& unit = plan.units[k];
    if (unit.kind == UnitKind::stretch) continue;
    if (k % 256 == 0) progress.update(static_cast<double>(k) / static_cast<double>(plan.units.size()), "merging");
    DeviceRecord& record = out[unit.device];
    std::optional<DeviceRecord> found;
    try {
      found = stored_record(folder, unit.id);
      if (found && !result_counts(folder, unit)) found.reset();
    } catch (const Error& error) {
      missing.damaged.push_back(one_line(error.problem()));
    }
    if (!found) {
      missing.units.push_back(k);
      if (record.problem.empty()) {
        record.problem = kNotThere;
        record.awaited = true;
      }
      continue;
    }
    if (record.channels.empty() && found->problem.empty()) record.report = report_of(unit, folder, options.relative_to);
    add_result(plan.devices[unit.device], *found, record);
    record.analysis = analyses.of(unit);
  }
  if (!options.partial) refuse_missing(plan, missing, folder);
  for (DeviceRecord& record : out) finish_record(record);
  return out;
}

}  // namespace libchar

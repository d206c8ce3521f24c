// fleet merge DIR… -o REPORT: the results of a fleet, or of several, as one report of the lot.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "help/next.hpp"
#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/process/free_memory.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fleet/plan.hpp"
#include "libchar/report/html/fleet_report.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;
namespace fs = std::filesystem;

struct MergeVerb {
  std::vector<std::string> fleets;
  std::string folder, name;
  bool json = false, force = false, partial = false;
};

/// Plans of several machines may have a copy each.
bool same_content(const std::string& a, const std::string& b) {
  constexpr std::size_t kMostLimits = std::size_t{16} << 20U;
  return a == b || file_text(a, kMostLimits) == file_text(b, kMostLimits);
}

/// The limits of each type; devices of one type have the same.
void add_limit_files(const FleetPlan& plan, std::map<std::string, std::string>& files) {
  for (const PlannedDevice& one : plan.devices) {
    if (one.limits.empty()) continue;
    const auto [at, fresh] = files.emplace(one.type, one.limits);
    if (!fresh && !same_content(at->second, one.limits))
      throw input_error("E0793", one.limits)
          .says("devices of the type \"{}\" have limits in two files", printable(one.type))
          .got(at->second)
          .hint("give them another `type` in the manifest, or the same limits");
  }
}

/// What is merged, read before any result is.
struct Merged {
  std::vector<DeviceRecord> records;
  FleetLotOptions options;
};

Merged merged(Session& session, const MergeVerb& verb) {
  Merged out;
  std::vector<PlannedFleet> fleets = read_fleets(verb.fleets);
  refuse_common_logs(fleets);
  std::map<std::string, std::string> limits;
  for (const PlannedFleet& one : fleets) add_limit_files(one.plan, limits);
  for (const auto& [type, file] : limits) out.options.limits[type] = read_limits_file(file);
  for (PlannedFleet& one : fleets) {
    std::vector<DeviceRecord> records =
        merged_records(one.plan, one.folder, {verb.partial, verb.folder}, session.terminal);
    std::move(records.begin(), records.end(), std::back_inserter(out.records));
    one.plan = {};
  }
  // What the plans took: the threads that compute the lot have heaps of their own.
  libchar::give_back_free_memory();
  return out;
}

/// The names of the folders, in an order that is not that of the command line.
std::string name_of_fleets(const MergeVerb& verb) {
  constexpr std::size_t kNamed = 4;
  if (!verb.name.empty()) return verb.name;
  std::vector<std::string> names;
  for (const std::string& fleet : verb.fleets) {
    const fs::path path = fs::absolute(fleet).lexically_normal();
    names.push_back((path.has_filename() ? path : path.parent_path()).filename().string());
  }
  std::sort(names.begin(), names.end());
  return names.size() > kNamed ? plural(names.size(), "fleet") : fmt::format("{}", fmt::join(names, ", "));
}

void run_merge(Session& session, MergeVerb& verb) {
  if (verb.folder.empty()) verb.folder = default_folder(verb.fleets.front());
  refuse_standard_output("--output", verb.folder);
  foresee_outputs(fleet_report_files(verb.folder), verb.folder, verb.fleets, verb.force);
  const Merged fleet = merged(session, verb);
  const FleetLot lot = fleet_lot(fleet.records, fleet.options);
  FleetReport report;
  report.records = fleet.records;
  report.lot = &lot;
  report.name = name_of_fleets(verb);
  report.command = session.command;
  report.next = next_steps(verb.folder, fleet.records, lot);
  const std::vector<std::string> files = write_fleet_report(report, verb.folder, verb.force);
  session.wrote = true;
  session.terminal.clear();
  if (verb.json) return print(dump_json(fleet_json(report)));
  print_beside(session, fleet_text(report, table_width()));
  std::string written = "\nwrote";
  for (const std::string& file : files) written += " " + printable(file);
  print_beside(session, written + "\n");
}

std::function<void()> merge_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<MergeVerb>();
  options.add_texts("DIR", verb->fleets, "folder of a fleet; several make one report").required();
  options.add_text("-o,--output", verb->folder, "folder for the report, made when absent (default: DIR-report)")
      .value_name("REPORT");
  options.add_text("--name", verb->name, "title of the fleet (default: the names of the folders)").value_name("TEXT");
  options.add_flag("--partial", verb->partial, "merge the existing results; devices without a result are listed");
  options.add_flag("--force", verb->force, "overwrite the report of an earlier merge");
  options.add_flag("--json", verb->json, "print lot.json to stdout instead of the tables");
  return [&session, verb] { run_merge(session, *verb); };
}

}  // namespace

VerbEntry verb_fleet_merge() {
  return {23,
          "fleet-merge",
          "Merge the results of a fleet into one report: spread, batches, outliers, limits",
          merge_options,
          {{"the report of the lot", "sensorchar fleet merge fleet -o report"},
           {"of batches that were planned on two machines", "sensorchar fleet merge april may -o spring"},
           {"of the results so far", "sensorchar fleet merge fleet -o so-far --partial"}}};
}

}  // namespace sensorchar

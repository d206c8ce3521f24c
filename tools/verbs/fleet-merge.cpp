// fleet merge DIR -o REPORT: the results of a fleet as one report of the lot.

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "libchar/core/error.hpp"
#include "libchar/core/output_files.hpp"
#include "libchar/core/text.hpp"
#include "libchar/fleet/merge.hpp"
#include "libchar/fleet/plan.hpp"
#include "libchar/report/fleet_report.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;
namespace fs = std::filesystem;

struct MergeVerb {
  std::string fleet, folder, name;
  bool json = false, force = false, partial = false;
};

/// The limits of each type; devices of one type have the same.
std::map<std::string, std::string> limit_files(const FleetPlan& plan) {
  std::map<std::string, std::string> files;
  for (const PlannedDevice& one : plan.devices) {
    if (one.limits.empty()) continue;
    const auto [at, fresh] = files.emplace(one.type, one.limits);
    if (!fresh && at->second != one.limits)
      throw Error(
          {ErrorKind::input,
           "E0793",
           one.limits,
           fmt::format("devices of the type \"{}\" have limits in two files", printable(one.type)),
           at->second,
           "give them another `type` in the manifest, or the same limits"});
  }
  return files;
}

void run_merge(Session& session, const MergeVerb& verb) {
  foresee_outputs({(fs::path(verb.folder) / "index.html").string(),
                   (fs::path(verb.folder) / "lot.json").string()},
                  verb.folder,
                  {},
                  verb.force);
  const FleetPlan plan = read_plan(verb.fleet);
  FleetLotOptions options;
  for (const auto& [type, file] : limit_files(plan)) options.limits[type] = read_limits_file(file);
  const std::vector<DeviceRecord> records =
      merged_records(plan, verb.fleet, {verb.partial, verb.folder}, session.terminal);
  const FleetLot lot = fleet_lot(records, options);
  FleetReport report;
  report.records = records;
  report.lot = &lot;
  report.name = verb.name.empty() ? fs::absolute(verb.fleet).lexically_normal().filename().string()
                                  : verb.name;
  report.command = session.command;
  const auto files = fleet_files(report, verb.folder);
  write_outputs(files, verb.folder, {}, verb.force);
  session.wrote = true;
  session.terminal.clear();
  if (verb.json) return print(dump_json(fleet_json(report)));
  print_beside(session, fleet_text(report, table_width()));
  std::string written = "\nwrote";
  for (const OutputFile& file : files) written += " " + printable(file.path);
  print_beside(session, written + "\n");
}

std::function<void()> merge_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<MergeVerb>();
  options.add_text("DIR", verb->fleet, "folder of a fleet").required();
  options.add_text("-o,--output", verb->folder, "folder for the report (made when absent)")
      .value_name("REPORT")
      .required();
  options.add_text("--name", verb->name, "of the fleet, in words (default: the name of its folder)")
      .value_name("TEXT");
  options.add_flag(
      "--partial", verb->partial, "merge what there is; devices without a result stand as such");
  options.add_flag("--force", verb->force, "overwrite the report of an earlier merge");
  options.add_flag("--json", verb->json, "print lot.json to stdout instead of the tables");
  return [&session, verb] { run_merge(session, *verb); };
}

}  // namespace

VerbEntry verb_fleet_merge() {
  return {23,
          "fleet-merge",
          "the results of a fleet as one report: spread, batches, outliers, limits",
          merge_options,
          {{"the report of the lot", "sensorchar fleet merge fleet -o report"},
           {"of what is done so far", "sensorchar fleet merge fleet -o so-far --partial"}}};
}

}  // namespace sensorchar

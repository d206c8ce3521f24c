// fleet status DIR…: how far a fleet is, or several.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fleet/jobs.hpp"
#include "libchar/fleet/plan.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct StatusVerb {
  std::vector<std::string> folders;
  bool json = false, list = false;
};

struct OneStatus {
  std::string folder;
  FleetPlan plan;
  FleetStatus status;
};

std::vector<OneStatus> status_of_all(Session& session, const StatusVerb& verb) {
  std::vector<OneStatus> out;
  for (PlannedFleet& fleet : read_fleets(verb.folders)) {
    FleetStatus status = fleet_status(fleet.plan, fleet.folder, session.terminal);
    out.push_back({fleet.folder.string(), std::move(fleet.plan), std::move(status)});
  }
  return out;
}

/// Counts and sentences of all; which units are missing is theirs.
FleetStatus together(const std::vector<OneStatus>& fleets) {
  FleetStatus out;
  for (const OneStatus& one : fleets) {
    const FleetStatus& s = one.status;
    out.devices += s.devices;
    out.units += s.units;
    out.done += s.done;
    out.no_result += s.no_result;
    out.damaged.insert(out.damaged.end(), s.damaged.begin(), s.damaged.end());
    out.unpublished.insert(out.unpublished.end(), s.unpublished.begin(), s.unpublished.end());
    out.seconds_left += s.seconds_left;
  }
  return out;
}

Json unit_json(const OneStatus& one, std::size_t k) {
  return {
      {"folder", one.folder}, {"task", task_file(k)}, {"device", one.plan.devices[one.plan.units[k].device].device}};
}

Json status_json(const Session& session, const std::vector<OneStatus>& fleets) {
  const FleetStatus status = together(fleets);
  Json document = document_head(session, "fleet-status", {});
  document["devices"] = status.devices;
  document["units"] = status.units;
  document["done"] = status.done;
  document["no_result"] = status.no_result;
  document["damaged"] = status.damaged;
  document["unpublished"] = status.unpublished;
  document["seconds_left"] = status.seconds_left;
  Json missing = Json::array(), damaged = Json::array();
  for (const OneStatus& one : fleets) {
    for (const std::size_t k : one.status.missing) missing.push_back(unit_json(one, k));
    for (std::size_t i = 0; i < one.status.damaged.size(); ++i) {
      const std::size_t k = one.status.damaged_units[i];
      Json unit = unit_json(one, k);
      unit["id"] = one.plan.units[k].id;
      unit["problem"] = one.status.damaged[i];
      damaged.push_back(std::move(unit));
    }
  }
  document["damaged_units"] = damaged;
  document["missing"] = missing;
  return document;
}

std::string next_command(const std::vector<OneStatus>& fleets) {
  std::vector<std::string> all;
  std::string left;
  for (const OneStatus& one : fleets) {
    all.push_back(one.folder);
    if (!one.status.missing.empty()) left += " " + shell_word(one.folder);
  }
  return left.empty() ? merge_command(all) : "sensorchar fleet run" + left;
}

std::string status_text(const std::vector<OneStatus>& fleets) {
  const FleetStatus status = together(fleets);
  std::string text;
  std::size_t missing = 0;
  for (const OneStatus& one : fleets) {
    missing += one.status.missing.size();
    if (fleets.size() > 1)
      text +=
          fmt::format("{}: {} of {} done\n", printable(one.folder), one.status.done, plural(one.status.units, "unit"));
  }
  text += fmt::format("{} of {} done", status.done, plural(status.units, "unit"));
  if (status.no_result > 0)
    text += fmt::format(", {} of them without a result: their logs could not be characterized", status.no_result);
  text += fmt::format("\n{} left, about {} on one core\n", missing, duration_text(status.seconds_left));
  if (!status.unpublished.empty())
    text += fmt::format("{} begun and not ended: workers at work, or killed\n", status.unpublished.size());
  for (const std::string& sentence : status.damaged) text += "damaged: " + sentence + "\n";
  return text + "next: " + next_command(fleets) + "\n";
}

void run_status(Session& session, const StatusVerb& verb) {
  const std::vector<OneStatus> fleets = status_of_all(session, verb);
  session.terminal.clear();
  if (verb.json) return print(dump_json(status_json(session, fleets)));
  if (!verb.list) return print_text(status_text(fleets));
  for (const OneStatus& one : fleets)
    for (const std::size_t k : one.status.missing) print(one.folder + "/" + task_file(k) + "\n");
}

std::function<void()> status_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<StatusVerb>();
  options.add_texts("DIR", verb->folders, "folder of a fleet, or of several").required();
  const Option json = options.add_flag("--json", verb->json, "print it as JSON");
  options.add_flag("--list", verb->list, "print the remaining tasks, one per line").excludes(json);
  return [&session, verb] { run_status(session, *verb); };
}

}  // namespace

VerbEntry verb_fleet_status() {
  return {22,
          "fleet-status",
          "Show the progress of a fleet: units done, left, damaged",
          status_options,
          {{"its progress", "sensorchar fleet status fleet"},
           {"the remaining tasks, for any shell", "sensorchar fleet status fleet --list"}}};
}

}  // namespace sensorchar

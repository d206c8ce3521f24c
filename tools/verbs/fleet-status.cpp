// fleet status DIR: how far a fleet is.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/core/readable.hpp"
#include "libchar/core/shell_word.hpp"
#include "libchar/core/text.hpp"
#include "libchar/fleet/plan.hpp"
#include "libchar/fleet/status.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct StatusVerb {
  std::string folder;
  bool json = false, list = false;
};

Json status_json(const Session& session, const FleetPlan& plan, const FleetStatus& status) {
  Json document = document_head(session, "fleet-status", {});
  document["devices"] = status.devices;
  document["units"] = status.units;
  document["done"] = status.done;
  document["no_result"] = status.no_result;
  document["damaged"] = status.damaged;
  document["unpublished"] = status.unpublished;
  document["seconds_left"] = status.seconds_left;
  Json missing = Json::array();
  for (const std::size_t k : status.missing)
    missing.push_back(
        {{"task", task_file(k)}, {"device", plan.devices[plan.units[k].device].device}});
  document["missing"] = missing;
  return document;
}

void run_status(Session& session, const StatusVerb& verb) {
  const FleetPlan plan = read_plan(verb.folder);
  const FleetStatus status = fleet_status(plan, verb.folder, session.terminal);
  session.terminal.clear();
  if (verb.json) return print(dump_json(status_json(session, plan, status)));
  if (verb.list) {
    for (const std::size_t k : status.missing) print(verb.folder + "/" + task_file(k) + "\n");
    return;
  }
  std::string text = fmt::format("{} of {} done", status.done, plural(status.units, "unit"));
  if (status.no_result > 0)
    text += fmt::format(", {} of them without a result: their logs could not be characterized",
                        status.no_result);
  text += fmt::format("\n{} left, about {} on one core\n",
                      status.missing.size(),
                      duration_text(status.seconds_left));
  if (!status.unpublished.empty())
    text += fmt::format("{} begun and not ended: workers at work, or killed\n",
                        status.unpublished.size());
  for (const std::string& sentence : status.damaged) text += "damaged: " + sentence + "\n";
  text += status.missing.empty()
              ? fmt::format("next: sensorchar fleet merge {} -o report\n", shell_word(verb.folder))
              : fmt::format("next: sensorchar fleet run {}\n", shell_word(verb.folder));
  print_text(text);
}

std::function<void()> status_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<StatusVerb>();
  options.add_text("DIR", verb->folder, "folder of a fleet").required();
  const Option json = options.add_flag("--json", verb->json, "print it as JSON");
  options.add_flag("--list", verb->list, "print the tasks that are left, a line each")
      .excludes(json);
  return [&session, verb] { run_status(session, *verb); };
}

}  // namespace

VerbEntry verb_fleet_status() {
  return {22,
          "fleet-status",
          "how far a fleet is: units done, left, damaged",
          status_options,
          {{"how far it is", "sensorchar fleet status fleet"},
           {"the tasks that are left, for any shell", "sensorchar fleet status fleet --list"}}};
}

}  // namespace sensorchar

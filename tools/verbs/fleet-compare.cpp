// fleet compare A B: two fleets, or two batches of one, by tests.

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "libchar/core/error.hpp"
#include "libchar/core/whole_file.hpp"
#include "libchar/fleet/merge.hpp"
#include "libchar/fleet/plan.hpp"
#include "libchar/report/fleet_comparison_text.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;
namespace fs = std::filesystem;

struct CompareFleetsVerb {
  std::vector<std::string> fleets, batches;
  std::string output;
  std::optional<double> false_alarm;
  bool json = false, force = false;
};

std::vector<DeviceRecord> records_of(const std::string& fleet, Session& session) {
  return merged_records(read_plan(fleet), fleet, {true, {}}, session.terminal);
}

std::vector<DeviceRecord> of_batch(const std::vector<DeviceRecord>& records,
                                   const std::string& batch,
                                   const std::string& fleet) {
  std::vector<DeviceRecord> out;
  std::set<std::string> batches;
  for (const DeviceRecord& record : records) {
    batches.insert(batch_title(record.batch));
    if (record.batch == batch) out.push_back(record);
  }
  if (out.empty())
    throw Error({ErrorKind::usage,
                 "E0205",
                 fleet,
                 "no device is of this batch",
                 batch,
                 fmt::format("it has {}", fmt::join(batches, ", "))});
  return out;
}

void run_compare_fleets(Session& session, const CompareFleetsVerb& verb) {
  const bool two = verb.fleets.size() == 2;
  if (verb.fleets.size() > 2 || (two ? !verb.batches.empty() : verb.batches.size() != 2))
    throw Error(
        {ErrorKind::usage,
         "E0205",
         "fleet compare",
         "two fleets are compared, or two batches of one",
         "",
         "sensorchar fleet compare A B, or sensorchar fleet compare DIR --batches OLD,NEW"});
  foresee_output(verb.output, {}, verb.force);
  std::vector<DeviceRecord> a = records_of(verb.fleets[0], session), b;
  CompareLotsOptions options;
  if (verb.false_alarm) options.false_alarm = *verb.false_alarm;
  if (two) {
    b = records_of(verb.fleets[1], session);
    options.name_a = verb.fleets[0];
    options.name_b = verb.fleets[1];
  } else {
    b = of_batch(a, verb.batches[1], verb.fleets[0]);
    a = of_batch(a, verb.batches[0], verb.fleets[0]);
    options.name_a = verb.batches[0];
    options.name_b = verb.batches[1];
  }
  const FleetComparison comparison = compare_lots(a, b, options);
  session.terminal.clear();
  const std::string text = verb.json ? dump_json(fleet_comparison_json(comparison, session.command))
                                     : fleet_comparison_text(comparison, table_width());
  if (verb.output.empty()) return verb.json ? print(text) : print_text(text);
  write_whole_file(verb.output, text, verb.force);
}

std::function<void()> fleet_compare_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<CompareFleetsVerb>();
  options.add_texts("DIR", verb->fleets, "folders of two fleets, or of one with --batches")
      .required();
  options.add_texts("--batches", verb->batches, "two batches of one fleet (OLD,NEW)")
      .separated_by_commas()
      .one_value_each();
  options.add_number(
      "--false-alarm",
      verb->false_alarm,
      "probability of finding any difference between lots that are alike (default: 0.05)",
      1e-9,
      0.5);
  options.add_document_output(verb->output);
  options.add_flag("--force", verb->force, "overwrite an existing file");
  options.add_flag("--json", verb->json, "JSON instead of a table");
  return [&session, verb] { run_compare_fleets(session, *verb); };
}

}  // namespace

VerbEntry verb_fleet_compare() {
  return {25,
          "fleet-compare",
          "two fleets, or two batches of one: what differs by more than chance",
          fleet_compare_options,
          {{"two batches of one fleet", "sensorchar fleet compare fleet --batches 2026-11,2026-12"},
           {"two fleets, as JSON", "sensorchar fleet compare march april --json"}}};
}

}  // namespace sensorchar

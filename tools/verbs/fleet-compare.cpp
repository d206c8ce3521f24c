// fleet compare A B: two fleets, or two batches of one, by tests.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/fleet/plan.hpp"
#include "libchar/lot/fleet_lot.hpp"
#include "libchar/report/compare/comparison_text.hpp"
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

[[noreturn]] void refuse_sides() {
  throw usage_error("E0205", "fleet compare")
      .says("two fleets are compared, or two batches of one")
      .hint(
          "sensorchar fleet compare A B, or sensorchar fleet compare DIR --batches OLD,NEW (where a name has a comma: "
          "--batches OLD --batches NEW)");
}

/// "OLD,NEW", or one a word.
std::vector<std::string> batches_of(const std::vector<std::string>& words) {
  if (words.size() != 1) return words;
  std::vector<std::string> out(1);
  for (const char c : words[0])
    if (c == ',')
      out.emplace_back();
    else
      out.back() += c;
  return out;
}

/// What is compared: records of both, and what is to be said of them.
struct Sides {
  std::vector<DeviceRecord> a, b;
  CompareLotsOptions options;
  std::vector<std::string> notes;
};

std::vector<DeviceRecord> records_of(const PlannedFleet& fleet, Session& session) {
  return merged_records(fleet.plan, fleet.folder, {true, {}}, session.terminal);
}

Sides sides_of_fleets(Session& session, const std::vector<std::string>& folders) {
  const std::vector<PlannedFleet> fleets = read_fleets(folders);
  refuse_common_logs(fleets);
  const bool in_order = fleets[0].folder == folders[0];
  Sides out;
  out.a = records_of(fleets[in_order ? 0 : 1], session);
  out.b = records_of(fleets[in_order ? 1 : 0], session);
  out.options.name_a = folders[0];
  out.options.name_b = folders[1];
  return out;
}

std::vector<DeviceRecord> of_batch(const std::vector<DeviceRecord>& records, const DeviceBatches& batches,
                                   const std::string& batch, const std::string& fleet) {
  std::vector<DeviceRecord> out;
  for (std::size_t r = 0; r < records.size(); ++r)
    if (batches.batch[batches.device_of[r]] == batch) out.push_back(records[r]);
  std::set<std::string> titles;
  for (const std::string& one : batches.batch) titles.insert(batch_title(one));
  if (out.empty())
    throw usage_error("E0205", fleet)
        .says("no device is of this batch")
        .got(batch)
        .hint("it has {}", fmt::join(titles, ", "));
  return out;
}

Sides sides_of_batches(Session& session, const std::string& folder, const std::vector<std::string>& names) {
  if (names[0] == names[1])
    throw usage_error("E0205", "--batches")
        .says("a batch is compared with another one")
        .got(names[0])
        .hint("name two: its devices would count twice");
  const std::vector<DeviceRecord> records = records_of({folder, read_plan(folder)}, session);
  const DeviceBatches batches = device_batches(records);
  Sides out;
  out.a = of_batch(records, batches, names[0], folder);
  out.b = of_batch(records, batches, names[1], folder);
  out.options.name_a = names[0];
  out.options.name_b = names[1];
  if (!batches.note.empty()) out.notes.push_back(batches.note);
  return out;
}

void run_compare_fleets(Session& session, const CompareFleetsVerb& verb) {
  const std::vector<std::string> batches = batches_of(verb.batches);
  const bool two = verb.fleets.size() == 2;
  if (verb.fleets.size() > 2 || (two ? !batches.empty() : batches.size() != 2)) refuse_sides();
  foresee_output(verb.output, verb.fleets, verb.force);
  Sides sides = two ? sides_of_fleets(session, verb.fleets) : sides_of_batches(session, verb.fleets[0], batches);
  if (verb.false_alarm) sides.options.false_alarm = *verb.false_alarm;
  FleetComparison comparison = compare_lots(sides.a, sides.b, sides.options);
  comparison.notes.insert(comparison.notes.end(), sides.notes.begin(), sides.notes.end());
  session.terminal.clear();
  const std::string text = verb.json ? dump_json(fleet_comparison_json(comparison, session.command))
                                     : fleet_comparison_text(comparison, table_width());
  if (verb.output.empty()) return verb.json ? print(text) : print_text(text);
  write_whole_file(verb.output, text, verb.force);
}

std::function<void()> fleet_compare_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<CompareFleetsVerb>();
  options.add_texts("DIR", verb->fleets, "folders of two fleets, or of one with --batches").required();
  options
      .add_texts("--batches", verb->batches, "two batches of one fleet (OLD,NEW; given twice where a name has a comma)")
      .one_value_each();
  options.add_number("--false-alarm", verb->false_alarm,
                     "probability of finding any difference between lots that are alike (default: 0.05)", 1e-9, 0.5);
  options.add_document_output(verb->output);
  options.add_flag("--force", verb->force, "overwrite an existing file");
  options.add_flag("--json", verb->json, "JSON instead of a table");
  return [&session, verb] { run_compare_fleets(session, *verb); };
}

}  // namespace

VerbEntry verb_fleet_compare() {
  return {25,
          "fleet-compare",
          "Compare two fleets, or two batches of one: significant differences",
          fleet_compare_options,
          {{"two batches of one fleet", "sensorchar fleet compare fleet --batches 2026-11,2026-12"},
           {"two fleets, as JSON", "sensorchar fleet compare march april --json"}}};
}

}  // namespace sensorchar

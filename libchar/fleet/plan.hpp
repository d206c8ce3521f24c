#pragma once
// A fleet's work in units: what is to be computed, what each unit is expected to cost, and where its result will be.
//
//   DIR/plan.jsonl    every unit, one line each, after a line about the fleet.
//   DIR/tasks/N.json  the same units, one file each, for schedulers.
//   DIR/results/      what they give (detail/result_store.hpp).

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/process/progress.hpp"
#include "libchar/fleet/manifest.hpp"
#include "libchar/fleet/unit.hpp"
#include "libchar/lot/device_record.hpp"

namespace libchar {

struct FleetPlanOptions {
  bool by_channel = false;  ///< one unit per channel of a log without a thermometer, or with `temperature`
  bool reports = true;      ///< each device's page and tables as well as its record
  std::uint64_t split_bytes = std::uint64_t{4}
                              << 30U;  ///< logs larger than this are divided in stretches where their format allows
  std::uint64_t stretch_bytes = std::uint64_t{1} << 30U;  ///< about, of a stretch
  bool skip_unreadable = false;                           ///< plan the others; the report lists the unreadable ones
};

/// A device of the plan: statements of the report in addition to the result.
struct PlannedDevice {
  std::string device, type, batch, limits, log, sha256;
  std::optional<double> temperature_c;
  std::string problem;  ///< why its log could not be planned
};

struct FleetPlan {
  std::vector<PlannedDevice> devices;  ///< in the order of the manifest
  std::vector<FleetUnit> units;        ///< of the devices in their order; a join behind its stretches
  /// Why logs above `split_bytes` are not divided, and whose; not in the file.
  std::map<std::string, std::set<std::size_t>> undivided;
  /// Logs that have warnings before their samples (an option that fits none of their channels); not in the file.
  std::vector<std::pair<std::string, Findings>> warned;
};

/// Looks into every log, takes its digest where none is stated, and reads the limits. Throws Error(input) for limits
/// that cannot be read, and for one log twice. Throws it as well for logs that cannot be read or have no sampling rate:
/// with their number, and the first few by name and reason.
FleetPlan plan_fleet(const Manifest& manifest, const FleetPlanOptions& options, Progress& progress = no_progress());

/// What a new plan in a folder takes the place of.
struct ReplacedPlan {
  std::uint64_t devices = 0;
  bool damaged = false;
};

/// None: there is no plan. Throws Error(input) for a plan.jsonl other than the plan of a fleet, which would be lost.
std::optional<ReplacedPlan> plan_in(const std::filesystem::path& folder);

/// Results in the folder that are of no unit of the plan.
std::size_t results_of_others(const FleetPlan& plan, const std::filesystem::path& folder);

/// Writes the tasks and, flushed to the disk, DIR/plan.jsonl, which makes them a plan. An existing plan is
/// replaced; results stay, and those of units that are still the same are used. Throws Error(output).
void write_plan(const FleetPlan& plan, const std::filesystem::path& folder);

/// Throws Error(input) for anything but a plan, or a plan of another version of the program.
FleetPlan read_plan(const std::filesystem::path& folder);

/// A unit by the file of its task, DIR/tasks/N.json. Tasks are not flushed one by one: one that a
/// power cut has torn, or that is gone, is read from the plan. Throws Error(input).
FleetUnit read_task(const std::string& file);

/// The folder of the fleet that a task is in, DIR. Throws Error(input) where it has no plan.
std::filesystem::path fleet_of_task(const std::string& file);

/// The file of a unit's task, relative to the folder of the plan.
std::string task_file(std::size_t unit);

// The results of a fleet put together, in the order of its plan whatever order they came in; of several fleets (batches
// that were planned on different machines) as if one plan had had all of their devices.

struct MergeOptions {
  bool partial = false;  ///< merge what there is; devices without a result say so
  /// the folder that the records' `report` is to be relative to; "": as an absolute path
  std::filesystem::path relative_to;
};

struct PlannedFleet {
  std::filesystem::path folder;
  FleetPlan plan;
};

/// In an order of their own, whatever order the folders are named in. Throws Error(input) as
/// read_plan does, and Error(usage) for a folder that is named twice.
std::vector<PlannedFleet> read_fleets(const std::vector<std::string>& folders);

/// Throws Error(input), by name, where two of the fleets have one log with the same settings: it would count twice.
void refuse_common_logs(const std::vector<PlannedFleet>& fleets);

/// Default folder of the report of these fleets: next to the working folder, not in it.
std::string merge_command(const std::vector<std::string>& folders);

/// A record for each device of the plan. Throws Error(input) where results are missing or damaged,
/// by name, unless `partial`.
std::vector<DeviceRecord> merged_records(const FleetPlan& plan, const std::filesystem::path& folder,
                                         const MergeOptions& options = {}, Progress& progress = no_progress());

// One unit of a fleet, by one worker.

enum class UnitOutcome {
  done,           ///< its result is there now
  already_there,  ///< it was there before, or another worker was first
  no_result,      ///< its result is there, and says why the log could not be characterized
};
template <>
inline constexpr auto enum_table<UnitOutcome> = enum_words<UnitOutcome, "done already_there no_result">;

struct UnitRun {
  UnitOutcome outcome = UnitOutcome::done;
  std::string problem{};  ///< of no_result: why
  Findings warnings{};    ///< of a log that was read to its end
};

/// Computes what is missing of the unit and publishes it in `fleet`/results, whole or not at all.
/// What the log's content does not allow is a result too. Throws Error(input) where the log was
/// changed after it was planned, Error(again) for what may be otherwise the next time: a log that
/// cannot be opened, parts of a join that are not there yet, a full disk.
UnitRun run_unit(const FleetUnit& unit, const std::filesystem::path& fleet, Progress& progress = no_progress());

}  // namespace libchar

#pragma once
// A fleet's work in units: what is to be computed, what each unit is expected to cost, and where its result will be.
//
//   DIR/plan.jsonl     every unit, a line each, behind a line about the fleet
//   DIR/tasks/N.json  the same units, a file each, for schedulers
//   DIR/results/      what they give (result_store.hpp)

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/core/process/progress.hpp"
#include "libchar/fleet/manifest.hpp"
#include "libchar/fleet/unit.hpp"

namespace libchar {

struct FleetPlanOptions {
  bool by_channel = false;  ///< a unit for each channel of a log
  bool reports = true;      ///< each device's page and tables as well as its record
  std::uint64_t split_bytes =
      std::uint64_t{4}
      << 30U;  ///< logs larger than this are divided in stretches where their format allows
  std::uint64_t stretch_bytes = std::uint64_t{1} << 30U;  ///< about, of a stretch
  bool skip_unreadable = false;  ///< plan the others; the report lists the unreadable ones
};

/// A device of the plan: statements of the report in addition to the result.
struct PlannedDevice {
  std::string device, type, batch, limits, log, sha256;
  std::optional<double> temperature_c;
  std::string problem;  ///< why its log could not be planned
};

struct FleetPlan {
  std::vector<PlannedDevice> devices;  ///< in the order of the manifest
  std::vector<FleetUnit> units;  ///< of the devices in their order; a join behind its stretches
  /// Why logs above `split_bytes` are not divided, and whose; not in the file.
  std::map<std::string, std::set<std::size_t>> undivided;
  /// Logs that have warnings in front of their samples (an option that fits none of their channels); not in the file.
  std::vector<std::pair<std::string, Findings>> warned;
};

/// Looks into every log, takes its digest where none is stated, and reads the limits. Throws
/// Error(input) for limits that cannot be read, for logs that cannot be read or have no sampling
/// rate (all of them named, the first few with the reason), and for one log twice.
FleetPlan plan_fleet(const Manifest& manifest,
                     const FleetPlanOptions& options,
                     Progress& progress = no_progress());

/// What a new plan in a folder takes the place of.
struct ReplacedPlan {
  std::uint64_t devices = 0;
  bool damaged = false;
};

/// None: there is no plan. Throws Error(input) for a plan.jsonl other than the plan of a fleet, which would be lost.
std::optional<ReplacedPlan> plan_in(const std::filesystem::path& folder);

/// Results in the folder that are of no unit of the plan.
std::size_t results_of_others(const FleetPlan& plan, const std::filesystem::path& folder);

/// Writes the tasks and, flushed to the disk, DIR/plan.jsonl, which makes them a plan. A plan that
/// stands there is replaced; results stay, and those of units that are still the same are used.
/// Throws Error(output).
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

}  // namespace libchar

#pragma once
// The results of a fleet put together, in the order of its plan whatever order they came in; of
// several fleets (batches that were planned on different machines) as if one plan had had all of
// their devices.

#include <filesystem>
#include <string>
#include <vector>

#include "libchar/core/process/progress.hpp"
#include "libchar/fleet/plan.hpp"
#include "libchar/lot/device_record.hpp"

namespace libchar {

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
std::vector<DeviceRecord> merged_records(const FleetPlan& plan,
                                         const std::filesystem::path& folder,
                                         const MergeOptions& options = {},
                                         Progress& progress = no_progress());

}  // namespace libchar

#pragma once
// The results of a fleet put together, in the order of its plan whatever order they came in.

#include <filesystem>
#include <vector>

#include "libchar/core/progress.hpp"
#include "libchar/fleet/plan.hpp"
#include "libchar/lot/device_record.hpp"

namespace libchar {

struct MergeOptions {
  bool partial = false;  ///< merge what there is; devices without a result say so
  /// the folder that the records' `report` is to be relative to; "": as an absolute path
  std::filesystem::path relative_to;
};

/// A record for each device of the plan. Throws Error(input) where results are missing or damaged, by name, unless `partial`.
std::vector<DeviceRecord> merged_records(const FleetPlan& plan,
                                         const std::filesystem::path& folder,
                                         const MergeOptions& options = {},
                                         Progress& progress = no_progress());

}  // namespace libchar

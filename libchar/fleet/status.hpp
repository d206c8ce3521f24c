#pragma once
// How far a fleet is.

#include <cstdint>
#include <filesystem>
#include <string>
#include <unordered_set>
#include <vector>

#include "libchar/core/process/progress.hpp"
#include "libchar/fleet/plan.hpp"

namespace libchar {

struct FleetStatus {
  std::uint64_t devices = 0, units = 0;
  std::uint64_t done = 0;                  ///< units with a result
  std::uint64_t no_result = 0;             ///< of these: the log could not be characterized
  std::vector<std::size_t> missing;        ///< units without one
  std::vector<std::string> damaged;        ///< sentences: results that count as none
  std::vector<std::size_t> damaged_units;  ///< whose these are
  std::vector<std::string> unpublished;    ///< folders of workers at work, or killed
  double seconds_left = 0;                 ///< of one core, as planned
};

FleetStatus fleet_status(const FleetPlan& plan,
                         const std::filesystem::path& folder,
                         Progress& progress = no_progress());

/// Ids of stretches whose log has been joined: their partial states are not needed any more,
/// whether they are there, count, or not.
std::unordered_set<std::string> joined_stretches(const FleetPlan& plan,
                                                 const std::filesystem::path& folder);

}  // namespace libchar

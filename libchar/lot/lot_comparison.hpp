#pragma once
// Two lots, or two batches of one, side by side: what differs, by how much, and by more than chance?
//
//   FleetComparison comparison = compare_lots(march, april, {.name_a = "March", .name_b = "April"});

#include <span>
#include <string>
#include <vector>

#include "libchar/lot/fleet_lot.hpp"

namespace libchar {

struct CompareLotsOptions {
  std::string name_a = "A", name_b = "B";
  double false_alarm = 0.05;  ///< probability of any difference between lots that are alike
};

/// One quantity of one channel in both lots.
struct LotDifference {
  std::string type, group;  ///< of the channel
  DeviceQuantity quantity = DeviceQuantity::white_noise;
  std::string channel_unit, unit;
  LotCounts counts_a, counts_b;
  LotFigures a, b;
  /// Mean of B over that of A where the quantity is compared as logarithm, else B less A. The interval is of this one alone.
  double change = 1;
  Interval change_ci95;
  double p_mean = 1, p_spread = 1;  ///< of as large a difference of lots that are alike
  /// The same of any of all tests (Holm): below `false_alarm` the lots differ.
  double p_mean_of_all = 1, p_spread_of_all = 1;
  bool mean_differs = false, spread_differs = false;
  std::string sentence;
};

struct FleetComparison {
  std::string name_a, name_b;
  std::size_t devices_a = 0, devices_b = 0;
  std::size_t tests = 0;
  double false_alarm = 0.05;
  std::vector<LotDifference> differences;  ///< in the order of the groups, whatever the result
  std::vector<std::string> not_compared;   ///< what only one has, or too few of
  std::vector<std::string> notes;          ///< of units; the caller's on how the lots were made
  std::string verdict;
};

/// Throws Error(usage) where a lot has no record, and Error(input) where they have no channel in common.
FleetComparison compare_lots(std::span<const DeviceRecord> a,
                             std::span<const DeviceRecord> b,
                             const CompareLotsOptions& options = {});

}  // namespace libchar

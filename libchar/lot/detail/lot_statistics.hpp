#pragma once
// Mean, spread, distribution, chart and capability of every quantity of every group.

#include <span>
#include <string>
#include <vector>

#include "libchar/lot/detail/lot_groups.hpp"
#include "libchar/lot/detail/quantity_values.hpp"
#include "libchar/lot/fleet_lot.hpp"

namespace libchar {

// What the steps of fleet_lot hand to each other.

/// A quantity with the values that it is of.
struct Statistic {
  QuantityLot lot;
  const LotGroup* group = nullptr;
  QuantityValues values;
  LimitCount limit;
  bool limited = false;
};

/// What is made once of all records.
struct Fleet {
  std::span<const DeviceRecord> records;
  SortedRecords sorted;
  std::vector<LotGroup> groups;
  std::vector<std::string> types, batches;
  std::vector<std::size_t> batch_of;  ///< of each device
  std::vector<GroupLimit> limits;
};

Fleet fleet_of(std::span<const DeviceRecord> records, const FleetLotOptions& options);

/// A place of a member: its first.
LotPlace place_of(const LotGroup& group, std::uint32_t member);

/// Of the quantities that any device has something of, group by group. Outliers are not looked for
/// here: each search has a share that depends on how many there are.
std::vector<Statistic> statistics_of(const Fleet& fleet);

}  // namespace libchar

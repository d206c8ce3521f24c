#pragma once
// What the steps of fleet_lot hand to each other.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libchar/lot/detail/lot_groups.hpp"
#include "libchar/lot/detail/lot_limits.hpp"
#include "libchar/lot/detail/quantity_values.hpp"
#include "libchar/lot/fleet_lot.hpp"

namespace libchar {

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

}  // namespace libchar

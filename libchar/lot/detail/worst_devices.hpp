#pragma once
// The devices of a fleet by what is wrong with them.

#include <vector>

#include "libchar/lot/detail/fleet_data.hpp"

namespace libchar {

/// Counts and marks the devices that stand out, fail, keep their limits.
void mark_devices(const Fleet& fleet, const std::vector<Statistic>& statistics, FleetLot& out);

/// Those that stand out or fail, the worst first, at most `most`.
void add_worst(const Fleet& fleet,
               const std::vector<Statistic>& statistics,
               std::size_t most,
               FleetLot& out);

}  // namespace libchar

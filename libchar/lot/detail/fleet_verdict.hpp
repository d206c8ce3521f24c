#pragma once
// A fleet in a paragraph.

#include <string>

#include "libchar/lot/fleet_lot.hpp"

namespace libchar {

std::string fleet_verdict(const FleetLot& lot);

}  // namespace libchar

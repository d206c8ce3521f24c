#pragma once
// Devices that the others of their group do not let expect.

#include <vector>

#include "libchar/lot/detail/fleet_data.hpp"

namespace libchar {

/// Fills `searched` and `outliers` of each quantity. `probability`: of naming any device where none
/// stands out.
void search_outliers(const Fleet& fleet, double probability, std::vector<Statistic>& statistics);

}  // namespace libchar

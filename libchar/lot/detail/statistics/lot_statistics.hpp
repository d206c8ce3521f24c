#pragma once
// Mean, spread, distribution, chart and capability of every quantity of every group.

#include <vector>

#include "libchar/lot/detail/fleet_data.hpp"

namespace libchar {

/// Of the quantities that any device has something of, group by group. Outliers are not looked for
/// here: each search has a share that depends on how many there are.
std::vector<Statistic> statistics_of(const Fleet& fleet);

}  // namespace libchar

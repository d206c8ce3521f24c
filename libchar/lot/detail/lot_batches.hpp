#pragma once
// The batches of a quantity side by side.

#include "libchar/lot/detail/fleet_data.hpp"

namespace libchar {

/// Fills `batches` and `batch_difference` of the quantity; no batches where there is one.
void add_batches(const Fleet& fleet, Statistic& statistic);

}  // namespace libchar

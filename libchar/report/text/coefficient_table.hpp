#pragma once
// All coefficients of a fleet as a table: one row per recording and channel, one column per property, for spreadsheets (CSV) and for NumPy (.npz,
// one array per column). A quantity that no device has, has no column.

#include <functional>
#include <span>
#include <string_view>

#include "libchar/lot/fleet_lot.hpp"

namespace libchar {

/// Gets a file piece by piece.
using TakeBytes = std::function<void(std::string_view)>;

/// In the order of the lot. What is not known is an empty cell.
void write_coefficients_csv(std::span<const DeviceRecord> records,
                            const FleetLot& lot,
                            const TakeBytes& take);

/// The same columns; what is not known is NaN. The status of a quantity is a place in the array `status_words`.
void write_coefficients_npz(std::span<const DeviceRecord> records,
                            const FleetLot& lot,
                            const TakeBytes& take);

}  // namespace libchar

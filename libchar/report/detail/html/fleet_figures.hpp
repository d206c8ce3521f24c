#pragma once
// Cells and figures of a fleet's quantities.

#include <string>
#include <vector>

#include "libchar/core/table/table.hpp"
#include "libchar/report/html/fleet_report.hpp"

namespace libchar {

/// "of mems" behind a channel where there are several types.
std::string group_title(const QuantityLot& quantity, const FleetLot& lot);

/// "22.5 °C", to a tenth of a degree.
std::string celsius_text(double t);

/// Group, what, mean, spread, where 95 % lie, counted, not counted, batches, limit: of channels, of
/// kinds of them, of both.
Table quantities_table(const FleetLot& lot, std::optional<bool> of_kind = {});

/// The Allan curves of all channels, a drawing for each quantity that they measure; "" where the
/// recordings are not in memory.
std::string allan_figures(const FleetReport& report);

/// Histogram, control chart, batches, repeats, limit of one quantity; "" where nothing is known of
/// it.
std::string quantity_figures(const FleetReport& report, const QuantityLot& quantity);

}  // namespace libchar

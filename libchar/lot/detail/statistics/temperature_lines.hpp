#pragma once
// The turn-on bias of devices that were recorded at several temperatures.

#include <optional>
#include <vector>

#include "libchar/lot/detail/quantity_values.hpp"
#include "libchar/lot/detail/statistics/grouped_lines.hpp"
#include "libchar/lot/fleet_lot.hpp"

namespace libchar {

/// A line over temperature of each member that has several, a mean of all others.
struct TemperatureLines {
  MemberRecordings recordings;  ///< without those of such members whose temperature is not known
  std::vector<bool> sloped;     ///< of each member that counts
  GroupedLines lines;           ///< x = temperature - reference
  TemperatureRuns runs;         ///< without slopes
};

/// Nothing where no member's temperatures lie kLeastTemperatureSpan apart.
std::optional<TemperatureLines> temperature_lines(const MemberRecordings& biases);

/// Of each member with a line, in order.
std::vector<DeviceSlope> device_slopes(const TemperatureLines& at);

}  // namespace libchar

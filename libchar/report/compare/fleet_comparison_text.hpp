#pragma once
// Two lots side by side, for scripts and a terminal.

#include <string>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/lot/lot_comparison.hpp"

namespace libchar {

/// {"format":"fleet-comparison",…}
Json fleet_comparison_json(const FleetComparison& comparison,
                           const std::vector<std::string>& command = {},
                           const std::vector<LogInfo>& inputs = {});
std::string fleet_comparison_text(const FleetComparison& comparison, std::size_t width = 0);

}  // namespace libchar

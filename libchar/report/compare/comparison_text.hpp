#pragma once
// A comparison for scripts, for pages and for a terminal.

#include <string>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/lot/lot_comparison.hpp"
#include "libchar/replay/comparison.hpp"
#include "libchar/replay/comparison_check.hpp"

namespace libchar {

/// The keys behind the head of {"format":"replay-comparison","version":1,…} (docs/replay.md).
Json comparison_json(const Comparison& comparison);

/// A table of the algorithms that ran, with what is unlike above it and the verdict below.
std::string comparison_text(const Comparison& comparison, std::size_t width = 0);

/// One page of Markdown.
std::string comparison_markdown(const Comparison& comparison);

/// Why an algorithm has no change, as far as the reports say: "only in A", "skipped in B"; empty
/// when it ran in both.
std::string side_of(const ComparedAlgorithm& row);

// Two lots side by side, for scripts and a terminal.

/// {"format":"fleet-comparison",…}
Json fleet_comparison_json(const FleetComparison& comparison,
                           const std::vector<std::string>& command = {},
                           const std::vector<LogInfo>& inputs = {});
std::string fleet_comparison_text(const FleetComparison& comparison, std::size_t width = 0);

}  // namespace libchar

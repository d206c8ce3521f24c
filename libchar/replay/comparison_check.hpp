#pragma once
// Checks on a comparison, such as a build server asks for: "rmse+5%", "minque:ns_per_sample+20%".

#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/file/growth_check.hpp"
#include "libchar/replay/comparison.hpp"

namespace libchar {

/// Metrics: rmse, regret (by so many points, as it is a share itself), ns_per_sample, peak_bytes;
/// labels are of algorithms.
using ComparisonCheck = GrowthCheck;

/// "[LABEL:]METRIC+NUMBER%". Throws Error(usage) with the nearest metric.
ComparisonCheck parse_comparison_check(std::string_view text);

/// One sentence for each algorithm that fails the check. Fails too: an algorithm with a value in A
/// and, though B names it, none there. Throws Error(usage) when `label` is in neither report,
/// and Error(check) when no algorithm has a value in A to hold against: a check that cannot fail.
std::vector<std::string> failures(const Comparison& comparison, const ComparisonCheck& check);

}  // namespace libchar

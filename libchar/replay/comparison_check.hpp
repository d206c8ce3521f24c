#pragma once
// Checks on a comparison, such as a build server asks for: "rmse+5%", "minque:ns_per_sample+20%".

#include <string>
#include <string_view>
#include <vector>

#include "libchar/replay/comparison.hpp"

namespace libchar {

struct ComparisonCheck {
  std::string text;    ///< as it was typed
  std::string label;   ///< of one algorithm; empty: of every one
  std::string metric;  ///< rmse, regret, ns_per_sample or peak_bytes
  double share = 0;  ///< B may be larger than A by this; of regret: by this much, as it is a share
};

/// "[LABEL:]METRIC+NUMBER%". Throws Error(usage) with the nearest metric.
ComparisonCheck parse_comparison_check(std::string_view text);

/// One sentence for each algorithm that fails the check. Fails too: an algorithm with a value in A
/// and, though B names it, none there. Throws Error(usage) when `label` stands in neither report,
/// and Error(check) when no algorithm has a value in A to hold against: a check that cannot fail.
std::vector<std::string> failures(const Comparison& comparison, const ComparisonCheck& check);

}  // namespace libchar

#pragma once
// Two replay reports side by side: A, the older or the accepted one, and B.

#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/file/growth_check.hpp"
#include "libchar/replay/report/replay_report.hpp"

namespace libchar {

/// What the intervals of two RMSE say of their difference.
enum class Difference {
  equal,         ///< the same number
  not_resolved,  ///< the 95 % intervals overlap
  better,        ///< B's interval is wholly below A's
  worse,         ///< B's interval is wholly above A's
  unknown,       ///< one of them has no RMSE or no interval
};

template <>
inline constexpr auto enum_table<Difference> = std::to_array<EnumWord<Difference>>({{Difference::equal, "equal"},
                                                                                    {Difference::not_resolved,
                                                                                     "not resolved"},
                                                                                    {Difference::better, "better"},
                                                                                    {Difference::worse, "worse"},
                                                                                    {Difference::unknown, "unknown"}});

/// One label; a side that does not have it is null.
struct ComparedAlgorithm {
  std::string label;
  const ReplayReport::Algorithm *a = nullptr, *b = nullptr;
  Difference difference = Difference::unknown;
  double rmse_change = 0;   ///< B / A - 1; NaN: one side has none
  double ns_change = 0;     ///< B / A - 1 of ns per sample
  double bytes_change = 0;  ///< B / A - 1 of the peak memory
  /// Both ran.
  bool both_ran() const { return a != nullptr && b != nullptr && a->ran && b->ran; }
};

struct Comparison {
  ReplayReport a, b;
  /// Why these are not two replays of one scene; empty: they are.
  std::vector<std::string> unlike;
  /// Differences that do not make it another scene: learning window, options, noise levels, program.
  std::vector<std::string> remarks;
  /// By RMSE of B; then those without one in B, by A's. Points into `a` and `b`.
  std::vector<ComparedAlgorithm> algorithms;
  std::string verdict;  ///< "RMSE: 1 better, 2 worse, 14 not resolved, 3 equal; …", and the best of each

  Comparison() = default;
  Comparison(const Comparison&) = delete;
  Comparison& operator=(const Comparison&) = delete;
  Comparison(Comparison&&) = default;
  Comparison& operator=(Comparison&&) = default;
};

/// Puts them side by side, like or unlike.
Comparison compare_replays(ReplayReport a, ReplayReport b);

/// Throws Error(input) that names the differences when the two are not of one scene.
void refuse_unlike(const Comparison& comparison);

// Checks on a comparison, such as a build server asks for: "rmse+5%", "minque:ns_per_sample+20%".

/// Metrics: rmse, regret (in points, as it is a share itself), ns_per_sample, peak_bytes;
/// labels are of algorithms.
using ComparisonCheck = GrowthCheck;

/// "[LABEL:]METRIC+NUMBER%". Throws Error(usage) with the nearest metric.
ComparisonCheck parse_comparison_check(std::string_view text);

/// One sentence for each algorithm that fails the check. Fails too: an algorithm with a value in A
/// and, though B names it, none there. Throws Error(usage) when `label` is in neither report,
/// and Error(check) when no algorithm has a value in A to hold against: a check that cannot fail.
std::vector<std::string> failures(const Comparison& comparison, const ComparisonCheck& check);

}  // namespace libchar

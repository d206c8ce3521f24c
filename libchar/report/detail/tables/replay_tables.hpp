#pragma once
// The tables of a replay, for its page, its summary and the terminal.

#include <vector>

#include "libchar/core/table/table.hpp"
#include "libchar/replay/view/replay_view.hpp"

namespace libchar {

/// All that ran, best first, bounds behind them: scores, costs.
Table algorithms_table(const ReplayView& view);
/// What stands behind names in a text.
inline constexpr const char* kStarNote =
    "* the best method, and those whose difference from it is not resolved; bounds look at the "
    "reference of the run itself.";
/// Facts of every algorithm, with the sentence of those that did not run.
Table needs_table(const ReplayView& view);
/// Scores for each input; none for one input.
std::vector<Table> input_tables(const ReplayView& view);
/// Per sensor: error, noise, quality.
Table sensors_table(const ReplayView& view);
/// Leave-one-out of each sensor; without rows where there is a reference.
Table blind_table(const ReplayView& view);
/// Final weights and variances; without rows when no algorithm has any.
Table weights_table(const ReplayView& view);
/// Faults that the scene knows against what each algorithm found; without rows where there is
/// neither.
Table faults_table(const ReplayView& view);
/// What one false alarm more often buys.
Table detection_table(const ReplayView& view);
/// How long each method that watches had each sensor out; without rows where none ever was.
Table out_share_table(const ReplayView& view);

}  // namespace libchar

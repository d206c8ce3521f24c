#pragma once
// The tables of a replay, for its page, its summary and the terminal.

#include <string>
#include <vector>

#include "libchar/core/table/table.hpp"
#include "libchar/replay/view/replay_view.hpp"

namespace libchar {

/// All that ran, best first, bounds behind them: scores, costs.
Table algorithms_table(const ReplayView& view);
/// What stands behind names in a text.
inline constexpr const char* kStarNote =
    "* the best method, and those whose difference from it is not resolved; bounds use the reference of the run "
    "itself.";
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
/// Faults that the scene knows against what each algorithm found; without rows where there is neither.
Table faults_table(const ReplayView& view);
/// What one false alarm more often buys.
Table detection_table(const ReplayView& view);
/// How long each method that watches had each sensor out; without rows where none ever was.
Table out_share_table(const ReplayView& view);

// What every table of methods says alike.

/// "RMSE, rad/s", or what is known without a reference.
Table::Column score_column(bool has_reference, const std::string& unit);
Cell regret_cell(double regret);
Cell time_cell(double nanoseconds);
/// NaN: not measured.
Cell memory_cell(double bytes);

// Numbers and facts of a replay as its reports write them.

/// "RMSE" or "leave-one-out RMS": what `AlgorithmResult::rmse` holds.
std::string score_name(const ReplayResult& result);
/// "0.0331 rad/s"; "–" for NaN.
std::string with_unit(double value, int digits, const std::string& unit);
/// Unit of the first input in its usual spelling, "" where none is stated.
std::string score_unit(const ReplayResult& result);
/// "400 s … 500 s", "600 s … the end".
std::string stretch_text(double from_s, double to_s);

/// Sensors, instants, optimum, lag, preparation: a sentence each.
std::vector<std::string> run_facts(const ReplayView& view);
/// "minque, mean: needs a reference", one a reason.
std::vector<std::string> skipped_words(const ReplayView& view);
/// What the algorithms remark.
std::vector<std::string> remark_words(const ReplayView& view);

}  // namespace libchar

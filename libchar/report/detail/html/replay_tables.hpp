#pragma once
// The tables of a replay's page (replay_html.cpp puts them together). Every text goes through
// escape.hpp.

#include <string>

#include "libchar/replay/view/replay_view.hpp"

namespace libchar {

/// All algorithms that ran, best first, bounds behind them: scores, costs.
std::string ranking_table(const ReplayView& view);
/// Card facts of every algorithm, with the sentence of those that did not run.
std::string needs_table(const ReplayView& view);
/// A table of scores for each input; "" for one input.
std::string inputs_table(const ReplayView& view);
/// Per sensor: error, noise, quality.
std::string sensors_table(const ReplayView& view);
/// Leave-one-out of each sensor; "" with a reference.
std::string blind_table(const ReplayView& view);
/// Final weights and variances; "" when no algorithm has any.
std::string weights_table(const ReplayView& view);
/// Faults that the scene knows against what each algorithm found; "" without either.
std::string faults_table(const ReplayView& view);
/// How long each method that watches had each sensor out; "" where none ever was.
std::string out_share_table(const ReplayView& view);

}  // namespace libchar

#pragma once
// Numbers and facts of a replay as its reports write them.

#include <string>
#include <vector>

#include "libchar/replay/view/replay_view.hpp"

namespace libchar {

/// "RMSE" or "leave-one-out RMS": what `AlgorithmResult::rmse` holds.
std::string score_name(const ReplayResult& result);
/// "0.0331 rad/s"; "–" for NaN.
std::string with_unit(double value, int digits, const std::string& unit);
/// Unit of the first input in its usual spelling, "" where none is stated.
std::string score_unit(const ReplayResult& result);
std::string usual_unit(const std::string& unit);
/// A point in time, in seconds without trailing zeros: "400 s".
std::string instant_text(double seconds);
/// "400 s … 500 s", "600 s … the end".
std::string stretch_text(double from_s, double to_s);

/// Sensors, instants, optimum, lag, preparation: a sentence each.
std::vector<std::string> run_facts(const ReplayView& view);
/// "minque, mean: needs a reference", one a reason.
std::vector<std::string> skipped_words(const ReplayView& view);
/// What the algorithms remark.
std::vector<std::string> remark_words(const ReplayView& view);

}  // namespace libchar

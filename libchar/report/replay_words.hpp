#pragma once
// What a replay's result says in words and small derived numbers: shared by its page, its table and
// its JSON.

#include <string>
#include <vector>

#include "libchar/replay/replay_result.hpp"

namespace libchar {

/// "RMSE" or "leave-one-out RMS": what `AlgorithmResult::rmse` holds.
std::string score_name(const ReplayResult& result);
/// "0.0331 rad/s"; "–" for NaN.
std::string with_unit(double value, int digits, const std::string& unit);
/// Unit of the first input in its usual spelling, "" when nobody said one.
std::string score_unit(const ReplayResult& result);
std::string usual_unit(const std::string& unit);
/// "0.12 %".
std::string people_percent(double share, int digits = 2);
/// A point in time, in seconds without trailing zeros: "400 s".
std::string people_instant(double seconds);
/// "400 s … 500 s", "600 s … the end".
std::string people_stretch(double from_s, double to_s);
/// "0.033 … 0.034"; "–" when it is not known.
std::string people_interval(const Interval& interval, int digits = 4);

/// What an algorithm asks of a scene, a phrase each; empty: nothing beyond the samples.
std::vector<std::string> needs_in_words(const fusion::Card& card);
/// Options that differ from the table's standard, "gamma = 0.99".
std::string settings_in_words(const fusion::Settings& settings);

/// On the front of error against a cost: no other method is at least as good in both and better in
/// one. Bounds are not on it and do not dominate.
struct ParetoFront {
  std::vector<bool> time, memory;  ///< one an algorithm
};
ParetoFront pareto_front(const ReplayResult& result);

/// Place of an algorithm in `result.algorithms`.
std::size_t index_of(const ReplayResult& result, const AlgorithmResult& algorithm);

}  // namespace libchar

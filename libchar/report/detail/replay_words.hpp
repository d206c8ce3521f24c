#pragma once
// Numbers of a replay as its page writes them.

#include <string>

#include "libchar/replay/replay_result.hpp"

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

}  // namespace libchar

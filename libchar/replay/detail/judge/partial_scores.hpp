#pragma once
// Scores of methods that ran on a part of the evaluation only, beside those of methods that ran on
// all of it: what they are compared by is what both saw.

#include "libchar/replay/error_meter.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {

/// Leave-one-out was cut short.
bool on_stretches(const AlgorithmResult& a);

/// Errors of two methods at the instants that both have.
struct CommonMeters {
  std::vector<ErrorMeter> copies;
  Meters a, b;
};
CommonMeters in_common(const Meters& a, const Meters& b);

/// The predictive RMS of each method that ran on stretches, for the whole evaluation: its ratio to the first method
/// that ran on all of it, from the instants in common, times that method's RMS. Both uncertainties are in its interval.
void extend_partial_scores(ReplayResult& result, const std::vector<Meters>& meters, const ScoreOptions& scoring);

}  // namespace libchar

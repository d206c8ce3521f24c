#pragma once
// Verdicts on one subject and one input, and the parts that make them.

#include <functional>
#include <span>
#include <vector>

#include "libchar/benchmark/detail/exact_estimators.hpp"
#include "libchar/benchmark/stress_bench.hpp"

namespace libchar {

/// Right digits of the worst of the values; zero expected: relative to the largest. 16: all that a double holds.
double right_digits(std::span<const double> values, std::span<const Exact> expected);
/// Of the values together: by the length of their difference, as of a spectrum or a path.
double right_digits_together(std::span<const double> values, std::span<const Exact> expected);

/// Runs what fills in a cell; its Error is a refusal.
StressCell stress_cell(const std::string& subject,
                       const std::string& input,
                       const std::function<void(StressCell&)>& run);

/// Compared: wrong below `stated`.
void judge_digits(double digits, double stated, StressCell& cell);
void judge_refused(const std::string& sentence, StressCell& cell);
void judge_held(bool held, const std::string& otherwise, StressCell& cell);

/// Estimators of a record and simulators of one.
std::vector<StressCell> stress_estimators(const StressBenchOptions& options, Progress& progress);
std::vector<StressCell> stress_simulators(const StressBenchOptions& options);
/// Fusion algorithms.
std::vector<StressCell> stress_fusion(const StressBenchOptions& options, Progress& progress);

}  // namespace libchar

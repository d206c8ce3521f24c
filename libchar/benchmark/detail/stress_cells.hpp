#pragma once
// Verdicts on one subject and one input, and the parts that make them.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "libchar/allan/deviation_types.hpp"
#include "libchar/benchmark/bench_document.hpp"

namespace libchar {
// The estimators' definitions, term by term in long double (64 bits of mantissa or more): what
// their fast forms are held against.

using Exact = long double;

/// A deviation of a record of rate without missing samples at m, tau = m dt; terms start at multiples of `stride`.
Exact exact_deviation(std::span<const double> y, double dt_s, DeviationType type, std::uint64_t m,
                      std::uint64_t stride);

/// Mean and standard deviation (n - 1).
std::vector<Exact> exact_moments(std::span<const double> y);

/// One-sided density by Welch's method: Hann, half overlap, means taken off segment by segment.
std::vector<Exact> exact_welch(std::span<const double> y, double rate_hz, std::size_t segment);

/// Orthonormal DCT-II of the record without its mean; c_0 is left at zero.
std::vector<Exact> exact_cosine_transform(std::span<const double> y);

/// Weights that sum to one and make the sum of squares of sum w_i e_i least, of n x N errors.
std::vector<Exact> exact_weights(const std::vector<std::vector<double>>& errors);

/// Right digits of the worst of the values; zero expected: relative to the largest. 16: all that a double holds.
double right_digits(std::span<const double> values, std::span<const Exact> expected);
/// Of the values together: by the length of their difference, as of a spectrum or a path.
double right_digits_together(std::span<const double> values, std::span<const Exact> expected);

/// Runs what fills in a cell; its Error is a refusal.
StressCell stress_cell(const std::string& subject, const std::string& input,
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

#pragma once
// How the points of a curve scatter: as a record of some length makes them, or by what they show themselves.

#include <string>

#include "libchar/fit/curve/curve_fit.hpp"
#include "libchar/fit/detail/curve/curve_likelihood.hpp"

namespace libchar {

/// Relative standard deviation of a variance that was read off a graph.
inline constexpr double kReading = 0.01;

/// Weighs by what a record of this length makes of ln(variance), with `reading` on top; the best
/// terms with these weights.
CurveSolution weigh_by_duration(const DigitisedCurve& curve, double duration_s, double reading, const TermSet& offered,
                                CurveProblem& problem);

/// Equal relative errors, those of the scatter about the fit; a half-sentence about them.
std::string weigh_evenly(const DigitisedCurve& curve, const TermSet& offered, CurveProblem& problem);

/// A spectrum's: chi-square with degrees of freedom that go as a power of the frequency, the one
/// that the points are most likely to come from.
std::string weigh_by_frequency(const DigitisedCurve& curve, const TermSet& offered, CurveProblem& problem);

}  // namespace libchar

#pragma once
// Least squares of the logarithm of a curve, y_j = ln v_j - ln (A theta)_j, whitened by what is
// known of the points' scatter.

#include <Eigen/Core>
#include <string>

#include "libchar/fit/curve/curve_fit.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"

namespace libchar {

struct CurveProblem {
  Eigen::ArrayXd value;  ///< variance or density, > 0
  Eigen::Array<double, Eigen::Dynamic, static_cast<int>(kTerms)> unit;
  /// L^-1 with cov(ln value) = s L L'; empty = identity (equal relative errors)
  Eigen::MatrixXd whitening;
  Eigen::ArrayXd weight;  ///< its diagonal, where it has nothing else
  Eigen::ArrayXd bias;    ///< of ln(value), where its expectation is not that of the curve; empty: none
  Eigen::Index size() const { return value.size(); }
};

struct CurveSolution {
  Mixture theta{};
  double sum_of_squares = 0;  ///< whitened
  bool converged = false;
  int iterations = 0;
};

/// Minimum over theta >= 0 of the free terms, the others held at `start` (null: zero).
CurveSolution solve_curve(const CurveProblem& problem, const TermSet& free, const Mixture* start = nullptr);

/// Best over all subsets of the free terms: the objective is not convex, a subset's own start finds
/// what the full set misses.
CurveSolution solve_curve_thoroughly(const CurveProblem& problem, const TermSet& free);

/// Whitened residuals ln value - ln model.
Eigen::ArrayXd curve_residuals(const CurveProblem& problem, const Mixture& theta);

/// J'J of the whitened residuals with respect to theta.
TermMatrix curve_information(const CurveProblem& problem, const Mixture& theta, const TermSet& terms);

// How the points of a curve scatter: as a record of some length makes them, or by what they show themselves.

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

#pragma once
// Profile likelihood: limits of one coefficient with the others at their best.

#include "libchar/fit/detail/band/bin_likelihood.hpp"

namespace libchar {

// Intervals of a coefficient that is reported because its likelihood ratio passed a threshold.

/// Rise of -2 ln L at which the lower 95 % limit of a term stands when it is reported only above `threshold` and was
/// found with `likelihood_ratio`: above the chi-square quantile 3.84, which it approaches far from the threshold.
/// Where it exceeds the likelihood ratio itself, the interval begins at zero.
double selected_rise(double likelihood_ratio, double threshold);

inline constexpr double kEachTail = 0.025;                ///< beyond each end of an interval
inline constexpr double kTwoSided95 = 3.841458820694124;  ///< chi-square, one degree of freedom
inline constexpr double kOneSided95 = 2.705543454095404;

/// Rise of -2 ln L at the upper limit that a theta of this skewness of its score exceeds with the probability `tail`.
double rise_below(double tail, double skewness);

/// The optimum a profile starts from.
struct Optimum {
  ModelPoint at;
  double half_deviance = 0;
};

/// The theta of the term under which as little as was found has the probability `tail`, or `at_least` where that is
/// larger; `sd` is a first guess of theta's standard deviation.
double profile_upper(const BinProblem& problem, const TermSet& terms, const Optimum& best, std::size_t term, double sd,
                     double tail, double at_least = 0);
/// Smallest theta with 2 (lnL_max - lnL_profile) <= rise; 0 when zero is not excluded.
double profile_lower(const BinProblem& problem, const TermSet& terms, const Optimum& best, std::size_t term, double sd,
                     double rise);

}  // namespace libchar

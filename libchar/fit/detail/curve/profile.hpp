#pragma once
// Profile likelihood: limits of one coefficient with the others at their best.

#include "libchar/fit/detail/band/bin_likelihood.hpp"

namespace libchar {

inline constexpr double kTwoSided95 = 3.841458820694124;  ///< chi-square, one degree of freedom
inline constexpr double kOneSided95 = 2.705543454095404;

/// The optimum a profile starts from.
struct Optimum {
  ModelPoint at;
  double half_deviance = 0;
};

/// Largest theta of the term with 2 (lnL_max - lnL_profile) <= rise; `sd` is a first guess of
/// theta's standard deviation.
double profile_upper(const BinProblem& problem,
                     const TermSet& terms,
                     const Optimum& best,
                     std::size_t term,
                     double sd,
                     double rise);
/// Smallest such theta; 0 when zero is not excluded.
double profile_lower(const BinProblem& problem,
                     const TermSet& terms,
                     const Optimum& best,
                     std::size_t term,
                     double sd,
                     double rise);

}  // namespace libchar

#pragma once
// The chi-square distribution at fractional and huge degrees of freedom.

#include "libchar/core/numeric/interval.hpp"

namespace libchar {

/// Quantile of chi-square with `dof` > 0 (fractional allowed) degrees of freedom, 0 < probability < 1; 1e-12 relative.
double chi_square_quantile(double probability, double dof);
/// The value exceeded with probability `tail`: the same quantile with no digits lost in 1 - tail.
double chi_square_upper_quantile(double tail, double dof);
/// P(X <= x).
double chi_square_cdf(double x, double dof);
/// P(X > x).
double chi_square_tail(double x, double dof);
/// Probability density at x.
double chi_square_density(double x, double dof);

/// Mean and variance of ln(X / dof): psi(dof/2) - ln(dof/2) and psi'(dof/2). For few degrees of freedom the logarithm of a mean of squares
/// is far below that of its expectation, and scatters by more than 2/dof.
struct LogMoments {
  double mean = 0, variance = 0;
};
LogMoments chi_square_log_moments(double dof);

/// Interval of a deviation from its edf: deviation * sqrt(edf / chi2_{(1±confidence)/2}(edf)). A mean of squares has at
/// least one degree of freedom: a smaller edf counts as 1, so that the interval is always finite.
Interval chi_square_interval(double deviation, double edf, double confidence);

}  // namespace libchar

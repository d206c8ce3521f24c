#pragma once
// Student's t, Fisher's F and the binomial distribution (Boost.Math), compiled once: their templates
// cost seconds wherever they are named.

#include "libchar/core/numeric/interval.hpp"

namespace libchar {

/// Quantile of Student's t with `dof` > 0 degrees of freedom, 0 < probability < 1.
double student_quantile(double probability, double dof);
/// P(T > t).
double student_tail(double t, double dof);

/// P(F <= f) and P(F > f) of Fisher's F with `dof1` and `dof2` degrees of freedom, f >= 0.
double fisher_cdf(double f, double dof1, double dof2);
double fisher_tail(double f, double dof1, double dof2);
/// The value exceeded with probability `tail`, no digits lost in 1 - tail.
double fisher_upper_quantile(double tail, double dof1, double dof2);

/// P(K <= k) and P(K > k) of `trials` trials that succeed with probability `each`.
double binomial_cdf(double k, double trials, double each);
double binomial_tail(double k, double trials, double each);

// The chi-square distribution at fractional and huge degrees of freedom.

/// Quantile of chi-square with `dof` > 0 (fractional allowed) degrees of freedom, 0 < probability < 1; relative error
/// 10⁻¹².
double chi_square_quantile(double probability, double dof);
/// The value exceeded with probability `tail`: the same quantile with no digits lost in 1 - tail.
double chi_square_upper_quantile(double tail, double dof);
/// P(X <= x).
double chi_square_cdf(double x, double dof);
/// P(X > x).
double chi_square_tail(double x, double dof);
/// Probability density at x.
double chi_square_density(double x, double dof);

/// Mean and variance of ln(X / dof): psi(dof/2) - ln(dof/2) and psi'(dof/2). For few degrees of freedom the logarithm
/// of a mean of squares is far below that of its expectation, and scatters by more than 2/dof.
struct LogMoments {
  double mean = 0, variance = 0;
};
LogMoments chi_square_log_moments(double dof);

/// Interval of a deviation from its edf: deviation * sqrt(edf / chi2_{(1±confidence)/2}(edf)). A mean of squares has at
/// least one degree of freedom: a smaller edf counts as 1, so that the interval is always finite.
Interval chi_square_interval(double deviation, double edf, double confidence);

}  // namespace libchar

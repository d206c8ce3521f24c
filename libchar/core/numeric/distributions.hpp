#pragma once
// Student's t, Fisher's F and the binomial distribution (Boost.Math), compiled once: their templates
// cost seconds wherever they are named. Chi-square has a file of its own (chi_square.hpp).

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

}  // namespace libchar

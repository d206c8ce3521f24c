#pragma once
// From the maximum of the likelihood to what is reported of each term.

#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/detail/curve/polish.hpp"
#include "libchar/fit/fit_options.hpp"
#include "libchar/fit/fit_result.hpp"

namespace libchar {

// Which terms are in the record: likelihood ratios at the boundary, backward elimination.

struct Decision {
  TermSet kept{};  ///< terms of the reported model
  ModelPoint at;   ///< its maximum
  double half_deviance = 0;
  /// 2 (lnL with - lnL without): of a kept term within the model, of a dropped one when it is added
  Mixture likelihood_ratio{};
  Mixture ratio_in_all{};  ///< the same within the model of all offered terms
  /// neither is needed when the other is there, but one of them is: flicker and walk, white noise and flicker
  std::array<bool, 2> either{};
  TermSet ambiguous{};  ///< the terms of those pairs
  int iterations = 0;
  bool converged = true;
};

Decision decide(const BinProblem& problem, const TermSet& offered, double threshold);

/// Fills term, theta, covariance, converged, iterations and the sentences about what cannot be told
/// apart; gives back the maximum of the likelihood.
ModelPoint report_coefficients(const BinProblem& problem, const Decision& decision, const FitOptions& options,
                               NoiseFit& fit);

/// Limits of terms without a value, and wide intervals of slow terms, reach to those that another model of the same
/// bins has for them.
void reach_limits(const BinProblem& other, const TermSet& offered, NoiseFit& fit);

/// Bounds and record lengths for 10 % of every term with a value; marks those above 30 % as undetermined.
void report_bounds(const TermSet& fitted, NoiseFit& fit);

/// Widens sd and intervals for a further parameter that was fitted jointly (the low-pass corner).
void widen_for_joint_parameter(const Mixture& log_theta_sd, NoiseFit& fit);

/// Adds an independent relative standard deviation to the value's and to both sides of its interval.
void widen_by(double relative_sd, Coefficient& term);

/// "bias instability B" for sentences.
std::string long_name(Term term);

}  // namespace libchar

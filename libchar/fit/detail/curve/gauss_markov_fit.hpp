#pragma once
// Does the record ask for a first-order Gauss-Markov process beside, or in place of, flicker and random walk?

#include <optional>
#include <vector>

#include "libchar/fit/detail/band/band.hpp"
#include "libchar/fit/fit_result.hpp"

namespace libchar {

/// A Gauss-Markov process that the bins were searched for, at its most likely correlation time.
struct GaussMarkovChoice {
  Band band;  ///< in which it is fitted; its `tau_s` is set where `needed`
  double tau_s = 0;
  double likelihood_ratio = 0;  ///< 2 (lnL with - lnL without), the offered terms in both
  bool needed = false;          ///< the terms alone are rejected (1 % of records of their kind)
  /// Not needed, but with white noise alone it is more likely than all offered terms: standard deviation (0: not so).
  double rival_sigma = 0;
  double half_deviance = 0;  ///< with the process
};

/// Looks for one; nothing where the record has no slow noise at all. `band` is that of the terms alone.
std::optional<GaussMarkovChoice> choose_gauss_markov(const std::vector<PowerBin>& bins, const Band& band,
                                                     double rate_hz, double duration_s, const TermSet& terms);

/// The most likely correlation time near that of the band, with the terms of `theta`.
double likeliest_tau(const std::vector<PowerBin>& bins, const Band& band, double rate_hz, const Mixture& theta);

/// Moves what was fitted in the ramp's column to `fit.gauss_markov`, with intervals of sigma and tau, and widens those
/// of the terms for the correlation time that was fitted with them.
void settle_gauss_markov(const std::vector<PowerBin>& bins, const GaussMarkovChoice& choice, NoiseFit& fit);

/// Says of a process that is not needed its progress from that, and what it would be where it is as good as the terms.
void report_not_needed(const GaussMarkovChoice& choice, NoiseFit& fit);

}  // namespace libchar

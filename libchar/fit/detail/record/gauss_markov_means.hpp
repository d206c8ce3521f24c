#pragma once
// Expected squared DCT-II coefficients of a first-order Gauss-Markov process (core/gauss_markov.hpp).

#include <cstdint>
#include <vector>

#include "libchar/fit/record/power_bins.hpp"

namespace libchar {

/// E[c_k²] of a process of unit variance with phi = exp(-dt/tau), n samples; exact for integer k in 1..n-1, between them the mean of odd
/// and even.
double gauss_markov_dct_mean(double k, std::uint64_t n, double dt_over_tau);

/// Mean over a bin's coefficients, per unit variance.
double gauss_markov_unit(const PowerBin& bin, double tau_s, double rate_hz);

}  // namespace libchar

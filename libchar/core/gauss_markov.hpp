#pragma once
// A first-order Gauss-Markov (Ornstein-Uhlenbeck) process: standard deviation sigma, correlation time tau, two-sided density
// S(f) = 2 sigma² tau / (1 + (2 pi f tau)²). Sampled every dt it is y_t = phi y_{t-1} + sigma sqrt(1 - phi²) w_t, phi = exp(-dt/tau).

#include <vector>

#include "libchar/core/coefficient.hpp"

namespace libchar {

/// What a simulation needs of it, and what is known of it.
struct GaussMarkovNoise {
  double sigma = 0;                ///< U; 0: there is none
  double tau_s = 0;                ///< correlation time
  std::vector<double> sigma_ci95;  ///< [low, high]; empty: not from a fit
  std::vector<double> tau_ci95_s;  ///< [low, high], [low] when the record gives no upper end
  Status status =
      Status::detected;  ///< undetermined: noise terms alone may explain the record as well
  bool operator==(const GaussMarkovNoise&) const = default;
};

}  // namespace libchar

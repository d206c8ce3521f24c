#pragma once
// Exact curves of a sampled first-order Gauss-Markov process of unit variance (core/gauss_markov.hpp).

namespace libchar {

/// Two-sided density at a frequency, 0 < f <= 1/(2 dt), of samples at 1/dt; 1/Hz.
double gauss_markov_spectrum(double tau_s, double frequency_hz, double dt_s);

/// Allan variance at averaging factor m >= 1.
double gauss_markov_allan_variance(double tau_s, double m, double dt_s);

/// Variance of the mean of m samples, and covariance of neighbouring means.
struct MeanCovariance {
  double variance = 1, neighbours = 1;
};
MeanCovariance gauss_markov_means(double tau_s, double m, double dt_s);

}  // namespace libchar

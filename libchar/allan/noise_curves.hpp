#pragma once
// Exact curves of the discrete noise models: Allan variance, generalised covariance of the phase,
// spectrum. (declared here, formulas and sources in noise_curves.cpp; docs/theory/allan.md)

#include "libchar/core/noise_terms.hpp"

namespace libchar {

/// Allan variance of unit coefficient (theta_term = 1) at averaging factor m >= 1, tau = m dt.
double unit_allan_variance(Term term, double m, double dt_s);

/// Sum over the terms of theta * unit_allan_variance.
double allan_variance(const Mixture& theta, double m, double dt_s);

/// Asymptotes as plotted: Q^2/tau, (2 ln2/pi) B^2, K^2 tau/3, 3 Qz^2/tau^2, R^2 tau^2/2 for unit coefficient.
double allan_asymptote(Term term, double tau_s);

/// Two-sided density S(f) of unit coefficient for samples at 1/dt, 0 < f <= 1/(2 dt) (exact
/// discrete form: 1, 1/(2π·dt)… with 2 sin(π f dt) in place of 2π f dt). The ramp has none: 0.
double unit_spectrum(Term term, double frequency_hz, double dt_s);
double spectrum(const Mixture& theta, double frequency_hz, double dt_s);

/// Flicker phase noise of unit coefficient, y_t = (x_t - x_{t-1})/dt with x unit flicker: two-sided
/// density 2 sin(pi f dt)/dt, and Allan variance (2/pi) (4 H_m - H_2m)/(m dt)².
double flicker_phase_spectrum(double frequency_hz, double dt_s);
double flicker_phase_allan_variance(double m, double dt_s);

/// Continuous asymptotes: 1, 1/(2π f), 1/(2π f)^2, (2π f)^2 dt for unit theta, two-sided.
double spectrum_asymptote(Term term, double frequency_hz, double dt_s);

/// H_n = 1 + 1/3 + … + 1/(2n-1) = [psi(n + 1/2) + gamma]/2 + ln 2, for real n >= 0 (0 for n = 0).
double odd_harmonic(double n);

/// Generalised covariance s(n) of the summed samples x_t = y_1 + … + y_t at lag n, unit coefficient: every combination
/// sum_j c_j x_{t+j} whose weights annihilate constants and straight lines has variance sum_jk c_j c_k s(j - k). White
/// and quantization are exact for integer n; at real n quantization is 0 except at n = 0. The ramp has none: 0.
double phase_covariance(Term term, double n, double dt_s);

/// The same for x summed once more, T with T(n+1) - 2 T(n) + T(n-1) = s(n): all that the modified Allan variance needs.
double summed_phase_covariance(Term term, double n, double dt_s);

// Exact curves of a sampled first-order Gauss-Markov process of unit variance (model/sensor_model.hpp).

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

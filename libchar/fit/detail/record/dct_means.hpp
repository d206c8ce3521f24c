#pragma once
// Expected squared DCT-II coefficients of every noise term: the model side of the likelihood.

#include <array>
#include <cstdint>
#include <vector>

#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/record/power_bins.hpp"

namespace libchar {

// Expected squared DCT-II coefficients of a first-order Gauss-Markov process (model/sensor_model.hpp).

/// E[c_k²] of a process of unit variance with phi = exp(-dt/tau), n samples; exact for integer k in 1..n-1, between
/// them the mean of odd and even.
double gauss_markov_dct_mean(double k, std::uint64_t n, double dt_over_tau);

/// Mean over a bin's coefficients, per unit variance.
double gauss_markov_unit(const PowerBin& bin, double tau_s, double rate_hz);

// Expected squared DCT-II coefficients of flicker phase noise: y_t = F (x_t - x_{t-1})/dt with x unit flicker, S_y(f) =
// F² 2 sin(pi f dt)/dt.

/// E[c_k²] per unit F², n samples: within 1e-3 for n >= 4096 (k whole, or between whole numbers for a mean over a bin).
double flicker_phase_dct_mean(double k, std::uint64_t n, double dt_s);

/// Means of every bin, in the order of the bins.
std::vector<double> flicker_phase_units(const std::vector<PowerBin>& bins, double rate_hz);

/// The bins of a clock's frequency: the place of the ramp, which a clock has none of, holds flicker phase noise.
void lend_flicker_phase(double rate_hz, std::vector<PowerBin>& bins);

/// Si(pi k) for integer k >= 0, 1e-15 relative.
double sine_integral_at_pi(std::uint64_t k);

/// E[c_k^2] per unit theta for a record of n point samples at spacing dt; real-valued k >= 1
/// allowed (bin centres of a bound).
std::array<double, kTerms> dct_mean(double k, std::uint64_t n, double dt_s);

/// E[c_k^2], k = 1..n-1 at [k-1], of a contrast-only process with generalised covariance g(0..n-1):
///   (2/n) sum_j g(j) e_j [(n-j) cos(a j) - sin(a j)/sin a],   e_0 = 1/2... as two real transforms
///   (one DCT-I and one DST-I; docs/theory/fit.md).
std::vector<double> dct_means_of_covariance(const std::vector<double>& g);

/// E[c_k^2] per unit theta for the series sqrt(m) * (mean of m samples), n of them: white noise keeps its level fs.
/// Exact for every term (flicker: second differences of the phase's generalised covariance).
class BlockMeanDct {
 public:
  BlockMeanDct(std::uint64_t n, std::uint64_t m, double dt_s);
  std::array<double, kTerms> mean(std::uint64_t k) const;

 private:
  std::uint64_t n_, m_;
  double dt_s_;
  std::vector<double> flicker_;
};

}  // namespace libchar

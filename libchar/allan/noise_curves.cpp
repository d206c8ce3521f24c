// Exact second moments of the sampled noise models. With nu = f dt, m = tau/dt and S(f) two-sided:
//
//   term          sample model                        S(f)                        Allan variance
//   white         y = Q/sqrt(dt) w                    Q^2                         Q^2/tau
//   flicker       y = (1 - z^-1)^(-1/2) B w           B^2 dt/(2 sin pi nu)        B^2 h_m/(4 pi)
//   walk          y_t = y_{t-1} + K sqrt(dt) w        K^2 dt^2/(4 sin^2 pi nu)    K^2 tau/3 (1 + 1/(2 m^2))
//   quantization  y_t = Qz (w_t - w_{t-1})/dt         4 sin^2(pi nu) Qz^2/dt      3 Qz^2/tau^2
//   ramp          y_t = R t dt                        none (deterministic)        R^2 tau^2/2
//
// h_m = 16(H_2m - H_m) + (4 H_m - H_2m)/m^2, H_m the sum of 1/(2 k - 1) for k = 1 … m. The flicker form is that of
// Kasdin, Proc. IEEE 83 (1995) 802 (fractional differencing). Its variogram is (4/pi) H_n; summing twice gives s(n)
// below, and the Allan variance [s(2m) - 4 s(m) + 3 s(0)]/m^2 (docs/theory/allan.md). h_m is the same thing arranged so
// that nothing cancels: H_2m - H_m tends to ln(2)/2.

#include "libchar/allan/noise_curves.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

namespace libchar {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSeriesFrom = 24;  // beyond it six terms of the series are exact to a rounding

/// H_n - (ln n + gamma)/2 - ln 2 = sum_k (1 - 2^(1-2k)) B_2k / (4 k n^2k), from the asymptotic
/// series of digamma(n + 1/2).
double odd_harmonic_remainder(double n) {
  const double z = 1 / (n * n);
  return z *
         (1.0 / 48 - z * (7.0 / 1920 -
                          z * (31.0 / 16128 - z * (127.0 / 61440 - z * (511.0 / 135168 - z * 1414477.0 / 134184960)))));
}

/// H_2m - H_m = 1/(2m+1) + … + 1/(4m-1), without the logarithms that cancel.
double odd_harmonic_octave(double m) {
  if (m >= kSeriesFrom) return 0.5 * std::numbers::ln2 + (odd_harmonic_remainder(2 * m) - odd_harmonic_remainder(m));
  if (std::floor(m) != m) return odd_harmonic(2 * m) - odd_harmonic(m);
  double sum = 0;
  for (double i = 2 * m; i > m; --i) sum += 1 / (2 * i - 1);
  return sum;
}

double flicker_allan_variance(double m) {
  const double small = odd_harmonic(m);
  const double octave = odd_harmonic_octave(m);
  return (16 * octave + (3 * small - octave) / (m * m)) / (4 * kPi);
}

/// Variance of the driving noise of the sample model of unit coefficient.
double driving_variance(Term term, double dt) {
  switch (term) {
    case Term::white:
      return 1 / dt;
    case Term::flicker:
      return 1;
    case Term::walk:
      return dt;
    case Term::quantization:
      return 1 / (dt * dt);
    case Term::ramp:
      return 0;
  }
  return 0;
}

}  // namespace

double odd_harmonic(double n) {
  assert(n >= 0);
  if (n >= kSeriesFrom)
    return 0.5 * (std::log(n) + std::numbers::egamma) + std::numbers::ln2 + odd_harmonic_remainder(n);
  double sum = 0;
  if (std::floor(n) == n) {
    for (double i = n; i > 0; --i) sum += 1 / (2 * i - 1);
    return sum;
  }
  double up = n;  // H_n = H_{n+1} - 1/(2n+1), up to where the series holds
  for (; up < kSeriesFrom; ++up) sum += 1 / (2 * up + 1);
  return odd_harmonic(up) - sum;
}

double unit_allan_variance(Term term, double m, double dt_s) {
  assert(m >= 1 && dt_s > 0);
  const double tau = m * dt_s;
  switch (term) {
    case Term::flicker:
      return flicker_allan_variance(m);
    case Term::walk:
      return tau / 3 * (1 + 0.5 / (m * m));
    default:
      return allan_asymptote(term, tau);
  }
}

double allan_variance(const Mixture& theta, double m, double dt_s) {
  double sum = 0;
  for (std::size_t t = 0; t < kTerms; ++t)
    if (theta[t] != 0) sum += theta[t] * unit_allan_variance(static_cast<Term>(t), m, dt_s);
  return sum;
}

double allan_asymptote(Term term, double tau_s) {
  switch (term) {
    case Term::white:
      return 1 / tau_s;
    case Term::flicker:
      return 2 * std::numbers::ln2 / kPi;
    case Term::walk:
      return tau_s / 3;
    case Term::quantization:
      return 3 / (tau_s * tau_s);
    case Term::ramp:
      return tau_s * tau_s / 2;
  }
  return 0;
}

double unit_spectrum(Term term, double frequency_hz, double dt_s) {
  const double chord = 2 * std::sin(kPi * frequency_hz * dt_s);  // -> 2 pi f dt at low frequency
  switch (term) {
    case Term::white:
      return 1;
    case Term::flicker:
      return dt_s / chord;
    case Term::walk:
      return dt_s * dt_s / (chord * chord);
    case Term::quantization:
      return chord * chord / dt_s;
    case Term::ramp:
      return 0;
  }
  return 0;
}

double spectrum(const Mixture& theta, double frequency_hz, double dt_s) {
  double sum = 0;
  for (std::size_t t = 0; t < kTerms; ++t)
    if (theta[t] != 0) sum += theta[t] * unit_spectrum(static_cast<Term>(t), frequency_hz, dt_s);
  return sum;
}

double spectrum_asymptote(Term term, double frequency_hz, double dt_s) {
  const double omega = 2 * kPi * frequency_hz;
  switch (term) {
    case Term::white:
      return 1;
    case Term::flicker:
      return 1 / omega;
    case Term::walk:
      return 1 / (omega * omega);
    case Term::quantization:
      return omega * omega * dt_s;
    case Term::ramp:
      return 0;
  }
  return 0;
}

// s: -|n|/2 (white), [(4n^2 - 1) H_n - 3 n^2]/(4 pi) (flicker), (|n|^3 - |n|)/12 (walk), 1 at n = 0
// (quantization); each the double sum of minus half the variogram of y.
double phase_covariance(Term term, double n, double dt_s) {
  n = std::fabs(n);
  const double variance = driving_variance(term, dt_s);
  switch (term) {
    case Term::white:
      return -variance * n / 2;
    case Term::flicker:
      return variance * ((4 * n * n - 1) * odd_harmonic(n) - 3 * n * n) / (4 * kPi);
    case Term::walk:
      return variance * n * (n * n - 1) / 12;
    case Term::quantization:
      return n == 0 ? variance : 0.0;
    case Term::ramp:
      return 0;
  }
  return 0;
}

// T: minus the walk's s (white), [(4n^2-1)(4n^2-9) H_n/48 - 25 n^4/72 + 95 n^2/144]/(4 pi) (flicker),
// (|n|^5 - 5|n|^3 + 4|n|)/240 (walk), |n|/2 (quantization); found by undetermined coefficients from T'' = s.
double summed_phase_covariance(Term term, double n, double dt_s) {
  n = std::fabs(n);
  const double z = n * n;
  const double variance = driving_variance(term, dt_s);
  switch (term) {
    case Term::white:
      return -variance * n * (z - 1) / 12;
    case Term::flicker:
      return variance * ((4 * z - 1) * (4 * z - 9) * odd_harmonic(n) / 48 - z * (25 * z / 72 - 95.0 / 144)) / (4 * kPi);
    case Term::walk:
      return variance * n * (z - 1) * (z - 4) / 240;
    case Term::quantization:
      return variance * n / 2;
    case Term::ramp:
      return 0;
  }
  return 0;
}

double flicker_phase_spectrum(double frequency_hz, double dt_s) {
  return 2 * std::sin(std::numbers::pi * frequency_hz * dt_s) / dt_s;
}

// x has the generalised covariance -(2/pi) H_n: its second difference at step m the variance (2/pi) (8 H_m - 2 H_2m).
double flicker_phase_allan_variance(double m, double dt_s) {
  const double tau_s = m * dt_s;
  return 2 / std::numbers::pi * (4 * odd_harmonic(m) - odd_harmonic(2 * m)) / (tau_s * tau_s);
}

// y_t = phi y_{t-1} + sqrt(1 - phi²) w_t, phi = exp(-dt/tau), covariance phi^|j|. With e = 1 - phi, E = 1 - phi^m:
//   S(f) = dt e (1 + phi) / (e² + 4 phi sin²(pi f dt))
//   variance of a mean of m:      [m (1 + phi)/e - 2 phi E/e²] / m²
//   covariance of neighbours:     phi E²/e² / m²
//   AVAR(m) = their difference
// For m dt << tau both are nearly one: there the difference is that of a random walk of K² = 2/tau,
// (2m² + 1) dt/(3 m tau), less 3/4 of m dt/tau of it.

double gauss_markov_spectrum(double tau_s, double frequency_hz, double dt_s) {
  const double x = dt_s / tau_s, phi = std::exp(-x), e = -std::expm1(-x);
  const double sine = std::sin(std::numbers::pi * frequency_hz * dt_s);
  return dt_s * e * (1 + phi) / (e * e + 4 * phi * sine * sine);
}

MeanCovariance gauss_markov_means(double tau_s, double m, double dt_s) {
  const long double x = static_cast<long double>(dt_s) / tau_s;
  const long double phi = std::exp(-x), e = -std::expm1(-x), all = -std::expm1(-x * m);
  return {static_cast<double>((m * (1 + phi) / e - 2 * phi * all / (e * e)) / m / m),
          static_cast<double>(phi * all * all / (e * e) / m / m)};
}

double gauss_markov_allan_variance(double tau_s, double m, double dt_s) {
  constexpr double kShort = 1e-5;
  const long double x = static_cast<long double>(dt_s) / tau_s, across = x * m;
  if (across < kShort) return static_cast<double>(x * (2 * m * m + 1) / (3 * m) * (1 - 0.75L * across));
  const long double phi = std::exp(-x), e = -std::expm1(-x), all = -std::expm1(-across);
  return static_cast<double>((m * (1 + phi) / e - phi * all * (2 + all) / (e * e)) / m / m);
}

}  // namespace libchar

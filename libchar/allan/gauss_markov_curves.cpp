// y_t = phi y_{t-1} + sqrt(1 - phi²) w_t, phi = exp(-dt/tau), covariance phi^|j|. With e = 1 - phi, E = 1 - phi^m:
//   S(f) = dt e (1 + phi) / (e² + 4 phi sin²(pi f dt))
//   variance of a mean of m:      [m (1 + phi)/e - 2 phi E/e²] / m²
//   covariance of neighbours:     phi E²/e² / m²
//   AVAR(m) = their difference
// For m dt << tau both are nearly one: there the difference is that of a random walk of K² = 2/tau,
// (2m² + 1) dt/(3 m tau), less 3/4 of m dt/tau of it.
#include "libchar/allan/gauss_markov_curves.hpp"

#include <cmath>
#include <numbers>

namespace libchar {

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
  if (across < kShort)
    return static_cast<double>(x * (2 * m * m + 1) / (3 * m) * (1 - 0.75L * across));
  const long double phi = std::exp(-x), e = -std::expm1(-x), all = -std::expm1(-across);
  return static_cast<double>((m * (1 + phi) / e - phi * all * (2 + all) / (e * e)) / m / m);
}

}  // namespace libchar

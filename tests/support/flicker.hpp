#pragma once
// What a filter of flicker noise gives, for tests of it.

#include <cmath>
#include <complex>
#include <numbers>

#include "libchar/simulate/detail/flicker.hpp"

namespace test {

using namespace libchar;

/// What the filter gives, computed from its sections (no simulation): impulse response at lag k,
/// |H|^2 at nu cycles a sample, and the variogram E(y_{t+n} - y_t)^2 of its stationary output, unit
/// driving noise. Fractional differencing has Gamma(k+1/2)/(Gamma(k+1) sqrt pi), 1/(2 sin pi nu), (4/pi) H_n.
inline double flicker_response(const FlickerFilter& filter, double k) {
  double sum = 0;
  for (std::size_t j = 0; j < filter.loss.size(); ++j)
    sum += filter.weight[j] * std::exp(k * std::log1p(-filter.loss[j]));
  return sum;
}

inline double flicker_power(const FlickerFilter& filter, double nu) {
  // 1 - p e^(-i w) = (1 - e^(-i w)) + q e^(-i w), the first bracket without cancellation
  const double w = 2 * std::numbers::pi * nu, half = std::sin(w / 2);
  const std::complex<double> chord(2 * half * half, std::sin(w)), turn(std::cos(w), -std::sin(w));
  std::complex<double> sum = 0;
  for (std::size_t j = 0; j < filter.loss.size(); ++j) sum += filter.weight[j] / (chord + filter.loss[j] * turn);
  return std::norm(sum);
}

inline double flicker_variogram(const FlickerFilter& filter, double n) {
  double sum = 0;
  for (std::size_t i = 0; i < filter.loss.size(); ++i) {
    const double fall = -std::expm1(n * std::log1p(-filter.loss[i]));  // 1 - p^n
    double shared = 0;  // over 1 - p_i p_j, from the losses q = 1 - p: nothing cancels
    for (std::size_t j = 0; j < filter.loss.size(); ++j)
      shared += filter.weight[j] / (filter.loss[i] + filter.loss[j] - filter.loss[i] * filter.loss[j]);
    sum += 2 * filter.weight[i] * fall * shared;
  }
  return sum;
}

}  // namespace test

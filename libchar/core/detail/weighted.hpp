#pragma once
// Weighted means of values with known variances and a spread on top, and where a falling function takes a value.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace libchar {

struct Weighted {
  double mean = 0, weights = 0, q = 0;  ///< q: sum of the squared deviations, weighted
};

/// Weights 1 / (v_i + square).
inline Weighted weighted(std::span<const double> y, std::span<const double> v, double square) {
  Weighted out;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double weight = 1 / (v[i] + square);
    out.weights += weight;
    out.mean += y[i] * weight;
  }
  out.mean /= out.weights;
  for (std::size_t i = 0; i < y.size(); ++i)
    out.q += (y[i] - out.mean) * (y[i] - out.mean) / (v[i] + square);
  return out;
}

/// x >= 0 at which a falling function takes the value; 0 when it is below it there already. Bracketed from `scale` on in steps of 4, then
/// false position that halves the weight of an end that stays (Illinois: Dowell & Jarratt, BIT 11 (1971) 168), bisection where that stalls.
template <class Function>
double falls_to(Function&& f, double value, double scale) {
  double low = 0, above = f(0.0) - value, high = scale, below = f(high) - value;
  if (!(above > 0)) return 0;
  for (int i = 0; i < 200 && below > 0; ++i) {
    low = high;
    above = below;
    high *= 4;
    below = f(high) - value;
  }
  for (int i = 0, side = 0; i < 200 && high - low > 1e-13 * high; ++i) {
    const double guess = high - below * (high - low) / (below - above);
    // A guess at an end would not move it: a step inside keeps the bracket shrinking.
    const double least = 1e-14 * high;
    const double x = i % 8 == 7 || !std::isfinite(guess)
                         ? (low + high) / 2
                         : std::clamp(guess, low + least, high - least);
    const double fx = f(x) - value;
    if (fx == 0) return x;
    if (fx > 0) {
      low = x;
      above = fx;
      if (side > 0) below /= 2;
      side = 1;
    } else {
      high = x;
      below = fx;
      if (side < 0) above /= 2;
      side = -1;
    }
  }
  return (low + high) / 2;
}

}  // namespace libchar

#pragma once
// Values that are each known to some accuracy and differ among themselves as well: runs of a sensor, sensors of a lot.
//   y_i = mu + d_i + e_i,   d_i ~ N(0, spread²),   e_i ~ N(0, v_i) with v_i known

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "libchar/core/numeric/interval.hpp"

namespace libchar {

struct RandomEffects {
  std::size_t count = 0;
  double mean = 0;
  Interval mean_ci95;    ///< by Student's t: very wide for two values, as it must be
  double spread = 0;     ///< standard deviation of d; 0: the scatter is that of the uncertainties
  Interval spread_ci95;  ///< low 0: a spread of zero is not excluded. NaN for fewer than two values
  double p = 1;          ///< probability of more scatter without any spread (chi-square of count - 1)
};

/// Throws nothing; `variance` > 0, one per value, at least one value.
RandomEffects random_effects(std::span<const double> value, std::span<const double> variance);

struct Outlier {
  std::size_t index = 0;
  double deviation = 0;  ///< from the mean of the others, in standard deviations of that difference
  double p = 1;          ///< of a larger deviation, of any of the values
};

inline constexpr std::size_t kFewestForOutliers = 4;

/// Values that the others make improbable. Each is compared with the mean and spread of the others (deleted residual,
/// Student's t). The worst is taken out first, then the worst of the rest, up to a third of them. The result ends with
/// the last that has p < `probability`. A p that was hidden by another outlier is given as `probability`. Empty for
/// fewer than kFewestForOutliers values.
std::vector<Outlier> find_outliers(std::span<const double> value, std::span<const double> variance,
                                   double probability = 0.01);

// Weighted means of values with known variances and a spread on top, and where a falling function takes a value.

struct Weighted {
  double mean = 0, weights = 0, q = 0;  ///< q: sum of the squared deviations, weighted
};

/// Weights 1 / (v_i + square). In lanes: sums that do not wait for each other take a quarter of the time.
inline Weighted weighted(std::span<const double> y, std::span<const double> v, double square) {
  constexpr std::size_t kWays = 4;
  const std::size_t n = y.size(), whole = n - n % kWays;
  double weights[kWays] = {}, means[kWays] = {}, q[kWays] = {};
  const auto add_mean = [&](std::size_t i, std::size_t lane) {
    const double weight = 1 / (v[i] + square);
    weights[lane] += weight;
    means[lane] += y[i] * weight;
  };
  for (std::size_t i = 0; i < whole; i += kWays)
    for (std::size_t lane = 0; lane < kWays; ++lane) add_mean(i + lane, lane);
  for (std::size_t i = whole; i < n; ++i) add_mean(i, i - whole);
  Weighted out;
  out.weights = (weights[0] + weights[1]) + (weights[2] + weights[3]);
  out.mean = ((means[0] + means[1]) + (means[2] + means[3])) / out.weights;
  const double mean = out.mean;
  const auto add_q = [&](std::size_t i, std::size_t lane) {
    q[lane] += (y[i] - mean) * (y[i] - mean) / (v[i] + square);
  };
  for (std::size_t i = 0; i < whole; i += kWays)
    for (std::size_t lane = 0; lane < kWays; ++lane) add_q(i + lane, lane);
  for (std::size_t i = whole; i < n; ++i) add_q(i, i - whole);
  out.q = (q[0] + q[1]) + (q[2] + q[3]);
  return out;
}

/// x >= 0 at which a falling function takes the value; 0 when it is below it there already. Bracketed from `scale` on
/// in steps of 4, then false position that halves the weight of an end that stays (Illinois: Dowell & Jarratt, BIT 11
/// (1971) 168), bisection where that stalls.
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
    const double x =
        i % 8 == 7 || !std::isfinite(guess) ? (low + high) / 2 : std::clamp(guess, low + least, high - least);
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

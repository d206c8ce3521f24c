#pragma once
// x = sum w_i y_i of the samples that are there, as y_1 + sum w_i (y_i - y_1): the input's offset costs no digits.

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {

struct WeightedMean {
  double x = std::numeric_limits<double>::quiet_NaN();
  double used = 0;  ///< share of the weights whose samples were there (1: all)
};

/// Missing samples: the weights of the others are scaled up to one.
inline WeightedMean weighted_mean_of_present(const double* y, const double* w, Eigen::Index n) {
  Eigen::Index first = 0;
  while (first < n && !usable(y[first])) ++first;
  if (first == n) return {};
  double sum = 0, used = 0, even = 0;
  Eigen::Index present = 0;
  for (Eigen::Index i = first; i < n; ++i) {
    if (!usable(y[i])) continue;
    sum += w[i] * (y[i] - y[first]);
    even += y[i] - y[first];
    used += w[i];
    ++present;
  }
  // All the weight was on missing channels: the others count alike rather than not at all.
  if (!(used > 0)) return {y[first] + even / static_cast<double>(present), 0};
  return {y[first] + sum / used, used};
}

/// The weights sum to one.
inline WeightedMean weighted_mean(const double* y, const double* w, Eigen::Index n) {
  const double base = y[0];
  double a = 0, b = 0;
  Eigen::Index i = 0;
  for (; i + 1 < n; i += 2) {
    a += w[i] * (y[i] - base);
    b += w[i + 1] * (y[i + 1] - base);
  }
  if (i < n) a += w[i] * (y[i] - base);
  const double sum = a + b;
  if (std::abs(sum) <= kLargestSample) return {base + sum, 1};
  return weighted_mean_of_present(y, w, n);
}

}  // namespace libchar::fusion

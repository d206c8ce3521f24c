// With p <= 5 unknowns the 2^p - 1 sets of positive unknowns can all be solved: the feasible one of least cost is the
// minimum. No iteration, hence no tolerance. Columns are scaled to a unit diagonal before the Cholesky factorisation.
#include "libchar/fit/detail/curve/nonnegative.hpp"

#include <cmath>

namespace libchar {
namespace {

using Small = std::array<std::array<double, kTerms>, kTerms>;

/// Solves the leading n by n system by Cholesky; false when not positive definite.
bool solve(Small& g, Mixture& x, std::size_t n) {
  for (std::size_t j = 0; j < n; ++j) {
    double pivot = g[j][j];
    for (std::size_t k = 0; k < j; ++k) pivot -= g[j][k] * g[j][k];
    if (!(pivot > 1e-14)) return false;
    g[j][j] = std::sqrt(pivot);
    for (std::size_t i = j + 1; i < n; ++i) {
      double sum = g[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= g[i][k] * g[j][k];
      g[i][j] = sum / g[j][j];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) x[i] -= g[i][k] * x[k];
    x[i] /= g[i][i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) x[i] -= g[k][i] * x[k];
    x[i] /= g[i][i];
  }
  return true;
}

}  // namespace

Mixture nonnegative_minimum(const TermMatrix& gram, const Mixture& right, const TermSet& free) {
  std::array<std::size_t, kTerms> unknown{};
  std::array<double, kTerms> scale{};
  std::size_t p = 0;
  for (std::size_t i = 0; i < kTerms; ++i) {
    const double diagonal = gram(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i));
    if (!free[i] || !(diagonal > 0)) continue;
    scale[p] = 1 / std::sqrt(diagonal);
    unknown[p++] = i;
  }
  Mixture best{};
  double best_gain = 0;
  for (unsigned set = 1; set < (1U << p); ++set) {
    std::array<std::size_t, kTerms> in{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < p; ++i) {
      if ((set >> i & 1U) != 0) in[n++] = i;
    }
    Small g{};
    Mixture x{}, b{};
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = b[i] = right[unknown[in[i]]] * scale[in[i]];
      for (std::size_t j = 0; j < n; ++j) {
        g[i][j] = gram(static_cast<Eigen::Index>(unknown[in[i]]), static_cast<Eigen::Index>(unknown[in[j]])) *
                  scale[in[i]] * scale[in[j]];
      }
    }
    if (!solve(g, x, n)) continue;
    double gain = 0;
    bool feasible = true;
    for (std::size_t i = 0; i < n; ++i) {
      feasible = feasible && x[i] > 0;
      gain += b[i] * x[i];
    }
    if (!feasible || !(gain > best_gain)) continue;
    best_gain = gain;
    best = {};
    for (std::size_t i = 0; i < n; ++i) best[unknown[in[i]]] = x[i] * scale[in[i]];
  }
  return best;
}

}  // namespace libchar

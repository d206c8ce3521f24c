#pragma once
// The spread within groups from Q(s²) = sum (y - fit)² / (v + s²), which is chi-square with `dof`
// degrees of freedom at the true s² and falls as s² grows: Q(s²) = dof, and an interval by the
// quantiles of Q (core/random_effects.cpp has the sources).

#include <cmath>
#include <span>

#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/chi_square.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/numeric/weighted.hpp"

namespace libchar {

struct WithinSpread {
  double sd = kNone;  ///< NaN where there is no degree of freedom
  Interval ci95 = {kNone, kNone};
};

/// `q` of a square, `variance`: the v that are known.
template <class Function>
WithinSpread within_spread(Function&& q, double dof, std::span<const double> variance) {
  WithinSpread out;
  if (dof < 1) return out;
  double scale = 0;
  for (const double v : variance) scale += v / static_cast<double>(variance.size());
  out.sd = std::sqrt(falls_to(q, dof, scale));
  // Not less than at the median of Q, as of random effects: values that lie close by chance do not
  // bound the spread by nothing.
  const double q0 = q(0), median = chi_square_quantile(0.5, dof);
  const double lift = q0 < median ? median / q0 : 1;
  const auto lifted = [&](double square) { return lift * q(square); };
  out.ci95 = {std::sqrt(falls_to(q, chi_square_quantile(0.975, dof), scale)),
              std::sqrt(falls_to(lifted, chi_square_quantile(0.025, dof), scale))};
  return out;
}

}  // namespace libchar

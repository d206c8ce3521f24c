#pragma once
// Values in groups, each known to some accuracy: batches of a lot, or several recordings of each device.
//   y_i = mu + b_g(i) + d_i + e_i,   b_g ~ N(0, between²),   d_i ~ N(0, within²),   e_i ~ N(0, v_i) with v_i known

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/numeric/random_effects.hpp"

namespace libchar {

struct GroupedEffects {
  double within = 0;  ///< standard deviation of d, the same in all groups; NaN where no group has two values
  Interval within_ci95;
  std::vector<double> mean,
      variance;           ///< of each group, the spread within counted; NaN for one without values
  RandomEffects between;  ///< of the groups' means; its spread is the standard deviation of b
  double p = 1;           ///< probability of means that differ more where b is zero (F)
};

/// `group` has one index below `groups` a value; `variance` > 0; two groups with values at least.
GroupedEffects grouped_effects(std::span<const double> value, std::span<const double> variance,
                               std::span<const std::size_t> group, std::size_t groups);

// The spread within groups from Q(s²) = sum (y - fit)² / (v + s²), which is chi-square with `dof`
// degrees of freedom at the true s² and falls as s² grows: Q(s²) = dof, and an interval by the
// quantiles of Q (core/random_effects.cpp has the sources).

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

// Devices of several channels: one that is a little off in all of them stands out as a device where no channel does
// by itself.
//   y_dc = mu_c + a_d + d_dc + e_dc,   a_d ~ N(0, r w²),   d_dc ~ N(0, w²),   e_dc ~ N(0, v_dc) with v_dc known

/// The means over the channels held against those of the other devices, as find_outliers does with values; index: the
/// device. `value` and `variance` device by device, `channels` of each, two at least.
std::vector<Outlier> find_device_outliers(std::span<const double> value, std::span<const double> variance,
                                          std::size_t channels, double probability);

// Values in groups that lie on a straight line in each: recordings of devices at several temperatures.
//   y_i = a_g + c_g x_i + d_i + e_i,   d_i ~ N(0, within²),   e_i ~ N(0, v_i) with v_i known
// A group without a slope is one at x = 0 as it stands anywhere: y_i = a_g + d_i + e_i.

struct GroupedLines {
  double within = 0;  ///< standard deviation of d, the same in all groups; NaN without a degree of freedom
  Interval within_ci95;
  double dof = 0;  ///< of the values about the lines, over all groups: `within` is known by as many
  /// Of each group, from v and `within` (from v alone where that is NaN); NaN for one without values.
  std::vector<double> at_zero, at_zero_variance;
  std::vector<double> slope, slope_variance;  ///< NaN for a group without a slope
  /// The slope's where `within` stands at the ends of its interval: what its being estimated does to them.
  std::vector<double> slope_variance_low, slope_variance_high;
  std::vector<double> residual_dof;  ///< values less those that line or mean take
};

/// `sloped`: of each group below `groups` whether it has a line; its x must differ. `variance` > 0.
GroupedLines grouped_lines(std::span<const double> value, std::span<const double> variance, std::span<const double> x,
                           std::span<const std::size_t> group, const std::vector<bool>& sloped);

}  // namespace libchar

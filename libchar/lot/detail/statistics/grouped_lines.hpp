#pragma once
// Values in groups that lie on a straight line in each: recordings of devices at several
// temperatures.
//   y_i = a_g + c_g x_i + d_i + e_i,   d_i ~ N(0, within²),   e_i ~ N(0, v_i) with v_i known
// A group without a slope is one at x = 0 as it stands anywhere: y_i = a_g + d_i + e_i.

#include <cstddef>
#include <span>
#include <vector>

#include "libchar/core/numeric/interval.hpp"

namespace libchar {

struct GroupedLines {
  double within =
      0;  ///< standard deviation of d, the same in all groups; NaN without a degree of freedom
  Interval within_ci95;
  double dof = 0;  ///< of the values about the lines, over all groups: `within` is known by as many
  /// Of each group, from v and `within` (from v alone where that is NaN); NaN for one without
  /// values.
  std::vector<double> at_zero, at_zero_variance;
  std::vector<double> slope, slope_variance;  ///< NaN for a group without a slope
  /// The slope's where `within` stands at the ends of its interval: what its being estimated does
  /// to them.
  std::vector<double> slope_variance_low, slope_variance_high;
  std::vector<double> residual_dof;  ///< values less those that line or mean take
};

/// `sloped`: of each group below `groups` whether it has a line; its x must differ. `variance` > 0.
GroupedLines grouped_lines(std::span<const double> value,
                           std::span<const double> variance,
                           std::span<const double> x,
                           std::span<const std::size_t> group,
                           const std::vector<bool>& sloped);

}  // namespace libchar

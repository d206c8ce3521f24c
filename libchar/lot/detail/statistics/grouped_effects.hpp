#pragma once
// Values in groups, each known to some accuracy: batches of a lot, or several recordings of each
// device.
//   y_i = mu + b_g(i) + d_i + e_i,   b_g ~ N(0, between²),   d_i ~ N(0, within²),   e_i ~ N(0, v_i) with v_i known

#include <cstddef>
#include <span>
#include <vector>

#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/numeric/random_effects.hpp"

namespace libchar {

struct GroupedEffects {
  double within =
      0;  ///< standard deviation of d, the same in all groups; NaN where no group has two values
  Interval within_ci95;
  std::vector<double> mean,
      variance;           ///< of each group, the spread within counted; NaN for one without values
  RandomEffects between;  ///< of the groups' means; its spread is the standard deviation of b
  double p = 1;           ///< probability of means that differ more where b is zero (F)
};

/// `group` has one index below `groups` a value; `variance` > 0; two groups with values at least.
GroupedEffects grouped_effects(std::span<const double> value,
                               std::span<const double> variance,
                               std::span<const std::size_t> group,
                               std::size_t groups);

}  // namespace libchar

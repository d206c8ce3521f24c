#pragma once
// Values that are each known to some accuracy and differ among themselves as well: runs of a sensor, sensors of a lot.
//   y_i = mu + d_i + e_i,   d_i ~ N(0, spread²),   e_i ~ N(0, v_i) with v_i known

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
  double p = 1;  ///< probability of more scatter without any spread (chi-square of count - 1)
};

/// Throws nothing; `variance` > 0, one per value, at least one value.
RandomEffects random_effects(std::span<const double> value, std::span<const double> variance);

struct Outlier {
  std::size_t index = 0;
  double deviation = 0;  ///< from the mean of the others, in standard deviations of that difference
  double p = 1;          ///< of a larger deviation, of any of the values
};

inline constexpr std::size_t kFewestForOutliers = 4;

/// Values that the others do not let expect: each against the mean and spread of the others (deleted residual, Student's t), the
/// worst taken out first, then the worst of the rest, up to a third of them; those up to the last with p < `probability`. A p that was
/// hidden by another outlier is given as `probability`. Nobody, of fewer than kFewestForOutliers values.
std::vector<Outlier> find_outliers(std::span<const double> value,
                                   std::span<const double> variance,
                                   double probability = 0.01);

}  // namespace libchar

#pragma once
// A measured figure with what is known of it, and the order statistics and means that make one.

#include <cstdint>
#include <limits>
#include <vector>

#include "libchar/core/numeric/interval.hpp"

namespace libchar {

/// NaN: not measured.
struct Figure {
  double value = std::numeric_limits<double>::quiet_NaN();
  /// about 95 %; infinite on a side where the values are too few to say
  Interval ci95 = {-std::numeric_limits<double>::infinity(),
                   std::numeric_limits<double>::infinity()};
  std::uint64_t count = 0;  ///< values behind it
};

/// Median of independent values and its distribution-free interval: the order statistics between
/// which the population's median lies with at least 95 % (binomial; David & Nagaraja, Order
/// Statistics, 2003, §7.1). Fewer than six values: no limits.
Figure median_figure(std::vector<double> values);

/// Median of times whose interval is to hold the median of another run of the same, too: order
/// statistics at 99 %, and at least 1.5 % to either side (where code and data come to lie differs
/// from run to run).
Figure time_figure(std::vector<double> values);

/// Mean and its interval by Student's t. One value: no limits.
Figure mean_figure(const std::vector<double>& values);

/// Root mean square of independent, about normal values with mean zero: chi-square with as many degrees of freedom.
Figure rms_figure(const std::vector<double>& values);

/// Share of `count` trials that hit, with Wilson's score interval.
Figure share_figure(std::size_t hits, std::size_t count);

/// Do the intervals leave it open which of two is larger?
bool unresolved(const Figure& a, const Figure& b);

}  // namespace libchar

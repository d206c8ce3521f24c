#pragma once
// Medians, and the deviation of normal values by one.

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>

namespace libchar {

/// Which value is the middle of an even number of them.
enum class Middle { lower, mean, upper };

/// Puts `values` into another order. NaN of none.
inline double median_in_place(std::span<double> values, Middle middle = Middle::mean) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const bool odd = values.size() % 2 == 1;
  const std::size_t half = (values.size() - (middle == Middle::lower ? 1 : 0)) / 2;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(half);
  std::nth_element(values.begin(), at, values.end());
  if (odd || middle != Middle::mean) return *at;
  return (*std::max_element(values.begin(), at) + *at) / 2;
}

/// Standard deviation of normal values over the median of what they are off their median (MAD): 1 / Phi^-1(3/4).
inline constexpr double kMadToSd = 1.482602218505602;

/// Standard error of the median of many normal values over that of their mean: sqrt(pi / 2).
inline constexpr double kMedianError = 1.2533141373155;

}  // namespace libchar

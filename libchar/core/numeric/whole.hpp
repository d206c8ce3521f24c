#pragma once
// From a double to a whole number: a bare cast of one that the type does not hold may give anything.

#include <algorithm>
#include <concepts>

namespace libchar {

/// The whole part of `value`, the nearer end of the range where it lies beyond, the lower end if it is not a number.
template <std::integral Whole>
Whole clamped_whole(double value, Whole lowest, Whole highest) {
  if (!(value > static_cast<double>(lowest))) return lowest;
  if (value >= static_cast<double>(highest)) return highest;
  return static_cast<Whole>(value);
}

}  // namespace libchar

#pragma once
// From one kind of number to a whole one: a bare cast of one that the type does not hold may give anything.

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace libchar {

/// The whole part of `value`, the nearer end of the range where it lies beyond, the end nearest to 0 if it is not a
/// number. Round, floor or ceil it before, if that is meant.
template <std::integral Whole>
Whole clamped_whole(double value, Whole lowest = std::numeric_limits<Whole>::min(),
                    Whole highest = std::numeric_limits<Whole>::max()) {
  if (value != value) return std::clamp<Whole>(0, lowest, highest);
  if (value <= static_cast<double>(lowest)) return lowest;
  if (value >= static_cast<double>(highest)) return highest;
  return static_cast<Whole>(value);
}

namespace detail {
/// A number of things in memory: where sizes have 32 bits (a web page), the largest of them for all
/// that memory could not hold.
constexpr std::size_t in_memory(std::uint64_t count) {
  return static_cast<std::size_t>(std::min<std::uint64_t>(count, std::numeric_limits<std::size_t>::max()));
}
}  // namespace detail

}  // namespace libchar

#pragma once
// Sums in eight lanes, added in one fixed order: the same bits for every vector width.

#include <cstddef>

namespace libchar {

inline constexpr std::size_t kLanes = 8;

inline double sum_of_lanes(const double (&lane)[kLanes]) {
  return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

}  // namespace libchar

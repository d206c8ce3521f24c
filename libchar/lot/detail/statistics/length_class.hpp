#pragma once

#include <algorithm>
#include <cmath>

namespace libchar {

/// Records of one class have about the same length, within a factor of sqrt 2: their fits err
/// alike.
inline long length_class(double samples) {
  return std::lround(2 * std::log2(std::max(1.0, samples)));
}

}  // namespace libchar

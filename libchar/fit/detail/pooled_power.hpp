#pragma once
// Mean squared DCT-II coefficients of one transform length, and the logarithmic bins they become.

#include <cstdint>
#include <vector>

#include "libchar/fit/power_bins.hpp"

namespace libchar {

/// Mean squared coefficients k = first.. of one transform length, pooled over `pooled` transforms.
struct PooledPower {
  std::uint64_t length = 0;   ///< points of the transform
  std::uint64_t spacing = 1;  ///< samples averaged in a point
  std::uint64_t first = 1;
  std::uint64_t pooled = 1;
  std::vector<double> mean;
};

/// Its bins, with their expectations; `clipped`: coefficients to leave out, none when empty.
void append_power_bins(const PooledPower& power,
                       double rate_hz,
                       const std::vector<char>& clipped,
                       std::vector<PowerBin>& bins);

}  // namespace libchar

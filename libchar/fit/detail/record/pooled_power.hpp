#pragma once
// Mean squared DCT-II coefficients of one transform length become logarithmic bins.

#include <vector>

#include "libchar/fit/record/power_bins.hpp"

namespace libchar {

/// The logarithmic bins of a power, with their expectations; `clipped`: coefficients to leave out,
/// none when empty.
void append_power_bins(const PooledPower& power,
                       double rate_hz,
                       const std::vector<char>& clipped,
                       std::vector<PowerBin>& bins);

}  // namespace libchar

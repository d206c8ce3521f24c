#pragma once
// How a record is divided in transforms: what PowerBinner and the parts of power_sums.hpp share.

#include <cstdint>
#include <span>

#include "libchar/fit/detail/pooled_power.hpp"

namespace libchar {

inline constexpr std::uint64_t kLeftToMeans =
    16;  ///< coefficients of a block that the series of means covers
inline constexpr std::uint64_t kMeansPerBlock = 64;
inline constexpr std::uint64_t kSmallestTransform =
    8;  ///< shorter segments carry nothing worth their edge effects
inline constexpr std::uint64_t kLongGap = 4096;  ///< shorter gaps are closed up

/// Squared coefficients first … end-1 of one transform of all points.
PooledPower record_power(std::span<const double> points,
                         std::uint64_t spacing,
                         std::uint64_t first,
                         std::uint64_t end);

}  // namespace libchar

#pragma once
// How a record is divided in transforms.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/fit/record/pooled_sums.hpp"
#include "libchar/fit/record/power_bins.hpp"

namespace libchar {

// Mean squared DCT-II coefficients of one transform length become logarithmic bins.

/// The logarithmic bins of a power, with their expectations; `clipped`: coefficients to leave out, none when empty.
void append_power_bins(const PooledPower& power, double rate_hz, const std::vector<char>& clipped,
                       std::vector<PowerBin>& bins);

inline constexpr std::uint64_t kLeftToMeans = 16;  ///< coefficients of a block that the series of means covers
inline constexpr std::uint64_t kMeansPerBlock = 64;
inline constexpr std::uint64_t kSmallestTransform = 8;  ///< shorter segments carry nothing worth their edge effects
inline constexpr std::uint64_t kLongGap = 4096;         ///< shorter gaps are closed up

/// The first coefficient of a transform of `length` points that blocks of `block` such points do
/// not leave to the series of their means.
std::uint64_t first_kept(std::uint64_t length, std::uint64_t block);
/// One behind the last coefficient of a series of `points` means, each of `per_mean`, that blocks
/// of `block` leave to it.
std::uint64_t end_of_left(std::uint64_t points, std::uint64_t per_mean, std::uint64_t block);

/// Squared coefficients first … end-1 of one transform of all points, which are single samples where `ends` are to be
/// taken out.
PooledPower record_power(std::span<const double> points, std::uint64_t spacing, std::uint64_t first, std::uint64_t end,
                         const detail::EndNoise* ends = nullptr);

/// Means of transforms of `length` points from coefficient `first` on; nothing without a transform.
void append_pooled(const PooledSums& sums, std::uint64_t length, std::uint64_t spacing, std::uint64_t first,
                   std::vector<PooledPower>& out);

}  // namespace libchar

#pragma once
// Welch's method with the median of the segments in place of their mean: bursts in a few segments do not count.

#include <span>

#include "libchar/spectrum/welch.hpp"

namespace libchar {

enum class SegmentAverage { mean, median };

template <>
inline constexpr auto enum_table<SegmentAverage> = enum_words<SegmentAverage, "mean median">;

/// Expected median of `count` independent powers of mean 1 with 2 degrees of freedom: of an even
/// number the mean of the middle two.
double expected_median(std::uint64_t count);

/// welch(), each bin the median of the segments' powers over its expected value. Degrees of freedom
/// are the mean's, less what a median of so many is worse (0.48 of them in the end). Throws as
/// welch; Error(usage) where the powers of all segments are more than 2 GiB.
Spectrum median_welch(std::span<const double> record,
                      double rate_hz,
                      const WelchOptions& options = {});

}  // namespace libchar

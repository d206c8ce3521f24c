#pragma once
// Timelines made small enough for a page; no extreme is lost.

#include "libchar/replay/replay_result.hpp"

namespace libchar {

/// Every `divisor` neighbouring bins become one: the smallest low, the largest high.
Timeline merged_bins(const Timeline& timeline, std::size_t divisor);

/// The smallest divisor that keeps the tracks of all algorithms together within what a page of 3 MB can hold.
std::size_t track_divisor(const ReplayResult& result);

}  // namespace libchar

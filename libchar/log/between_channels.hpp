#pragma once
// What only several channels of a log show together. An accelerometer at rest reads the gravity of the Earth: a triad
// whose mean is another number has another unit, another scale, or gravity was taken out. And no sensor has the noise
// of another one.

#include <functional>
#include <span>

#include "libchar/log/quality.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

/// Adds a finding to each axis of a triad of accelerometers that rests and does not read gravity within 15 %. Adds one
/// to every channel that repeats an earlier one sample by sample, as it is or with its sign turned. `quality`: of each.
void judge_together(std::span<const Channel> channels, const std::function<ChannelQuality&(std::size_t)>& quality);

}  // namespace libchar

#pragma once
// An accelerometer at rest reads the gravity of the Earth: a triad whose mean is another number has another unit,
// another scale, or gravity was taken out.

#include <functional>
#include <span>

#include "libchar/log/quality.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

/// Adds a finding to each axis of a triad of accelerometers that rests and does not read gravity within 15 %.
/// `quality`: of each channel.
void judge_gravity(std::span<const Channel> channels, const std::function<ChannelQuality&(std::size_t)>& quality);

}  // namespace libchar

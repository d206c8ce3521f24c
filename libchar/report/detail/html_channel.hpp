#pragma once
// One channel's section of the page. Every text that reaches the page goes through escape.hpp.

#include <string>

#include "libchar/characterize/characterization_view.hpp"

namespace libchar {

/// The section of one channel: plots, numbers, trust, data quality, units for consumers, points of
/// the curve.
std::string channel_section(const ChannelView& channel, const LogInfo& log, std::size_t index);

}  // namespace libchar

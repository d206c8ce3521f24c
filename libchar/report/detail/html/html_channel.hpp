#pragma once
// One channel's section of the page. Every text that reaches the page goes through escape.hpp.

#include <string>

#include "libchar/characterize/characterization_view.hpp"

namespace libchar {

struct ChannelLayout {
  bool open = false;   ///< not folded
  bool trace = false;  ///< the record in time stands here, and not above
};

/// What can be unfolded of one channel: plots, numbers, trust, data quality, units for consumers, points of the curve.
std::string channel_section(const ChannelView& channel,
                            const LogInfo& log,
                            std::size_t index,
                            const ChannelLayout& layout);

}  // namespace libchar

#pragma once
// Channels of several sides that measure the same, whatever their names.

#include <string>
#include <string_view>
#include <vector>

#include "libchar/characterize/compare/characterization_comparison.hpp"

namespace libchar {

namespace detail {

/// "gyro_x" for "wx", "GyrX" and "angular_velocity.x" in a unit of angular rate, "baro" for a pressure; the name
/// itself where the unit is not known.
std::string usual_channel_name(std::string_view name, std::string_view unit);

/// A channel in a group.
struct PairedChannel {
  std::size_t side = 0;
  const ReportedChannel* channel = nullptr;
  double factor = 1;  ///< to the unit of the group
};

struct ChannelPairs {
  ComparedGroup group;  ///< its name, quantity, axis and unit
  std::vector<PairedChannel> channels;
};

/// By its own name or the usual one; nothing wanted: all are.
bool is_chosen(const ReportedChannel& channel, const std::vector<std::string>& wanted);

/// Groups of the channels that `wanted` chooses, in the order of their first channels; also those of one channel
/// only.
std::vector<ChannelPairs> paired_channels(const std::vector<ReportedCharacterization>& sides,
                                          const std::vector<std::string>& wanted);

/// Groups of one quantity and several axes with one channel of each side that takes part in all of them.
struct AxesTogether {
  ComparedGroup group;
  std::vector<std::vector<PairedChannel>> sides;  ///< the axes of each
};
std::vector<AxesTogether> axes_together(const std::vector<ChannelPairs>& pairs);

}  // namespace detail
}  // namespace libchar

#pragma once
// Messages that are JSON documents: every number in them is a field ("angular_velocity.x", "data[2]").

#include "libchar/log/ros/messages/message_decoder.hpp"

namespace libchar {

/// The fields are those of the example; without one there is a reason.
DecoderOrReason json_decoder(const MessageFormat& format);

}  // namespace libchar

#pragma once
// What is known of the common ROS types beyond their definition: units (REP-103 and the comments of
// the definitions), which of them sensors write, which are no rows of numbers, and the definitions
// themselves, for logs that do not carry them (rosbag2 before Iron).

#include <string>
#include <string_view>
#include <vector>

#include "libchar/log/ros/messages/message_definition.hpp"

namespace libchar {

struct KnownMember {
  std::string unit;   ///< of all numbers in it; "" when not known
  bool usual = true;  ///< no covariance, no header
};

/// Of the field `member` in a message of `type` ("sensor_msgs/Imu").
KnownMember known_member(std::string_view type, std::string_view member);

/// Do sensors write this type?
bool sensor_type(std::string_view type);

/// Why nothing of this type is read ("images"); "" when it may be.
std::string_view no_numbers_of(std::string_view type);

/// The definitions of common types that a log may lack: `type` and what it is made of, as many
/// versions as there have been, the newest first. Empty when it is not known.
std::vector<MessageTypes> known_definitions(std::string_view type);

/// known_messages.msg, embedded at build time: the types as REPs and distributions have them, one a paragraph: its
/// name, then its fields. Bounds, constants and comments, which no byte of a message depends on, are left out. Where a
/// type has changed, the newest stands first.
std::string_view known_message_text();

/// Adds what is known of types that `types` uses and has not.
void complete_types(MessageTypes& types);

}  // namespace libchar

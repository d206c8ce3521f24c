#pragma once
// Definitions of ROS messages as logs carry them: the fields of a type in their order, and of every
// type that it is made of. Source: ROS wiki "msg" (ROS 1), docs.ros.org "Interfaces" (ROS 2),
// MCAP's registry "ros1msg" and "ros2msg" (several types in one text, parted by lines of 80 "=").

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace libchar {

enum class Primitive : std::uint8_t {
  boolean,
  i8,
  u8,
  i16,
  u16,
  i32,
  u32,
  i64,
  u64,
  f32,
  f64,
  time,       ///< of ROS 2 (builtin_interfaces/Time, /Duration): i32 seconds, u32 nanoseconds
  time1,      ///< of ROS 1: u32 seconds, u32 nanoseconds
  duration1,  ///< of ROS 1: i32 seconds, i32 nanoseconds
  text,
  wide_text,
  message  ///< no primitive: another type
};

enum class Repeat : std::uint8_t { once, fixed, variable };

struct MessageField {
  std::string name;
  Primitive kind = Primitive::f64;
  std::string type;  ///< of a message: "geometry_msgs/Vector3"
  Repeat repeat = Repeat::once;
  std::uint64_t count = 1;  ///< of a fixed array
};

struct MessageType {
  std::string name;
  std::vector<MessageField> fields;
};

/// By name: "sensor_msgs/Imu", without the "/msg" of ROS 2.
using MessageTypes = std::map<std::string, MessageType, std::less<>>;

/// "sensor_msgs/Imu" for "sensor_msgs/msg/Imu" and for itself.
std::string plain_type_name(std::string_view type);

/// Adds `type` and the types behind it in `text` to `types`; those that are there already stay. Returns what is wrong
/// with the text, "" when nothing is. `ros1`: time and duration are those of ROS 1.
std::string add_message_types(std::string_view type, std::string_view text, bool ros1, MessageTypes& types);

// What is known of the common ROS types beyond their definition: units (REP-103 and the comments of
// the definitions), which of them sensors write, which are no rows of numbers, and the definitions
// themselves, for logs that do not carry them (rosbag2 before Iron).

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

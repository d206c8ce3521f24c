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

}  // namespace libchar

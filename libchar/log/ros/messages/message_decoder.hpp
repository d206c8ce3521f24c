#pragma once
// Numbers of one topic's messages, whatever they are serialized by.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libchar/log/ros/messages/message_program.hpp"

namespace libchar {

class MessageDecoder {
 public:
  virtual ~MessageDecoder() = default;
  virtual const std::vector<NumberField>& fields() const = 0;
  /// The field that is the sensor's own stamp.
  virtual std::optional<std::size_t> stamp() const = 0;
  /// Arrays that have no fields because they are too long.
  virtual bool oversized() const = 0;
  /// What `decode` is to do: slot i of a row is fields[i]; `stamp` is taken as one.
  virtual void select(const std::vector<std::size_t>& fields, std::optional<std::size_t> stamp) = 0;
  /// One message; `rounded` counts integers that no double holds.
  virtual Decoded decode(std::span<const std::byte> message, std::span<double> row, std::int64_t& stamp,
                         std::uint64_t& rounded) = 0;
};

/// What a log says of the messages of a topic.
struct MessageFormat {
  std::string type;                 ///< "sensor_msgs/msg/Imu"
  std::string message_encoding;     ///< "cdr", "ros1", "json"
  std::string definition_encoding;  ///< "ros2msg", "ros1msg", …; "" when there is no definition
  std::string definition;
  std::vector<std::byte> example;  ///< a message; may be empty
};

inline constexpr std::string_view kNoDefinition = "the log has no definition of this type";

struct DecoderOrReason {
  std::unique_ptr<MessageDecoder> decoder;  ///< nullptr when there is none
  std::string why_not;
};

/// Never throws over what the log says: what cannot be read has a reason.
DecoderOrReason make_decoder(const MessageFormat& format);

}  // namespace libchar

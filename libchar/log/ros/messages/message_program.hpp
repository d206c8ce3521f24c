#pragma once
// Numbers out of serialized ROS messages. A type becomes a short list of steps: stretches of fixed
// size, in which the offset of every number that is wanted is known beforehand, and between them
// what has a length of its own (texts, arrays). Sources: ROS wiki "Connection header" and "msg"
// (ROS 1: packed, little endian); OMG DDS-XTYPES 1.3, 7.4 (CDR: 4 bytes of encapsulation, values
// aligned to their size from the byte behind it; at most to 8, in version 2 to 4).

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libchar/log/ros/messages/message_definition.hpp"

namespace libchar {

enum class Wire : std::uint8_t { ros1, cdr, cdr2 };

/// Of a message whose wire is one of CDR's, by its first bytes.
struct Encapsulation {
  bool known = false;
  Wire wire = Wire::cdr;
  bool big_endian = false;
};
Encapsulation read_encapsulation(std::span<const std::byte> message);

/// A number of a message: where in `MessageProgram::run` it goes is said by whoever compiles.
struct NumberField {
  std::string name;  ///< "angular_velocity.x", "position[2]"
  std::string unit;
  Primitive kind = Primitive::f64;
  bool usual = true;  ///< no covariance, no header
};

struct ProgramStep;

struct MessageProgram {
  Wire wire = Wire::cdr;
  std::vector<ProgramStep> steps;
  std::uint64_t least_bytes = 0;  ///< of a message, without what aligns it
  bool wanted = false;            ///< some number is taken
  bool lists = false;             ///< some of them out of arrays of variable length, which may be shorter
};

/// One number to take: its distance from the beginning of its stretch.
struct Take {
  std::uint64_t offset = 0;
  Primitive kind = Primitive::f64;
  std::uint32_t slot = 0;
};

struct FixedStretch {
  std::uint64_t bytes = 0;
  std::vector<Take> takes;
};

struct ProgramStep {
  enum class Kind : std::uint8_t { stretch, texts, numbers, messages };
  Kind kind = Kind::stretch;
  bool counted = false;                  ///< a count stands in front (variable arrays)
  std::uint64_t count = 1;               ///< where none does
  std::array<FixedStretch, 8> stretch;   ///< by the position in front, modulo 8; of ROS 1 the first only
  Primitive number = Primitive::f64;     ///< of `numbers`
  std::vector<std::uint32_t> slots;      ///< of the first elements of `numbers`; kNoSlot = not wanted
  std::vector<MessageProgram> elements;  ///< of the first elements of `messages`
  std::vector<MessageProgram> rest;      ///< of all others: one, or none for what has no bytes
};

inline constexpr std::uint32_t kNoSlot = 0xffffffff, kStampSlot = 0xfffffffe;

/// What a type looks like as numbers, and how they are taken out.
struct CompiledMessage {
  std::vector<NumberField> fields;
  std::size_t stamp = kNoSlot;  ///< field that is the sensor's own stamp
  MessageProgram program;
  std::string problem;     ///< why it cannot be compiled; "" when it can
  bool oversized = false;  ///< arrays or fields were left out because there are too many
};

struct CompileOptions {
  Wire wire = Wire::cdr;
  std::vector<std::uint32_t> slots;    ///< by field; those behind its end are not wanted
  std::span<const std::byte> example;  ///< a message of the type, for the lengths of variable arrays; may be empty
};

/// Compiles `type` of `types`. Arrays of up to kListedElements have fields; variable ones as many as in the example.
CompiledMessage compile_message(const MessageTypes& types, std::string_view type, const CompileOptions& options);

inline constexpr std::size_t kListedElements = 64;
inline constexpr std::size_t kMostNumbers = 4096;  // of a topic

/// What came of a message.
enum class Decoded : std::uint8_t { well, misfit, other_length };

/// Takes the numbers of `message` into `row` by their slots (NaN where an array is shorter), the
/// stamp into `stamp` in ns. misfit: the bytes are not those of the type. other_length: they are,
/// but an array is longer or shorter than in the example.
Decoded run_program(const MessageProgram& program, std::span<const std::byte> message, std::span<double> row,
                    std::int64_t& stamp, std::uint64_t& rounded);

}  // namespace libchar

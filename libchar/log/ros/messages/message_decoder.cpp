#include "libchar/log/ros/messages/message_decoder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/text/text.hpp"
#include "libchar/log/ros/messages/json_messages.hpp"
#include "libchar/log/ros/messages/known_messages.hpp"

namespace libchar {
namespace {

class CompiledDecoder final : public MessageDecoder {
 public:
  CompiledDecoder(MessageTypes types, std::string type, Wire wire, std::vector<std::byte> example)
      : types_(std::move(types)), type_(std::move(type)), example_(std::move(example)) {
    options_.wire = wire;
    options_.example = example_;
    compiled_ = compile_message(types_, type_, options_);
  }
  CompiledDecoder(const CompiledDecoder&) = delete;
  CompiledDecoder& operator=(const CompiledDecoder&) = delete;
  ~CompiledDecoder() override = default;

  const std::string& problem() const { return compiled_.problem; }
  const std::vector<NumberField>& fields() const override { return compiled_.fields; }
  bool oversized() const override { return compiled_.oversized; }
  std::optional<std::size_t> stamp() const override {
    if (compiled_.stamp == kNoSlot) return std::nullopt;
    return compiled_.stamp;
  }

  // Is the example of this type?
  bool fits() {
    if (example_.empty()) return true;
    std::int64_t stamp = 0;
    std::uint64_t rounded = 0;
    return run_program(compiled_.program, example_, {}, stamp, rounded) != Decoded::misfit;
  }

  void select(const std::vector<std::size_t>& fields, std::optional<std::size_t> stamp) override {
    options_.slots.assign(compiled_.fields.size(), kNoSlot);
    for (std::size_t i = 0; i < fields.size(); ++i)
      options_.slots[fields[i]] = static_cast<std::uint32_t>(i);
    copy_ = kNoSlot;
    if (stamp) {
      // A field may be both a channel and the time: the channel is then made of the stamp.
      copy_ = options_.slots[*stamp];
      options_.slots[*stamp] = kStampSlot;
    }
    program_ = compile_message(types_, type_, options_).program;
    options_.slots.clear();
  }

  Decoded decode(std::span<const std::byte> message,
                 std::span<double> row,
                 std::int64_t& stamp,
                 std::uint64_t& rounded) override {
    const Decoded result = run_program(program_, message, row, stamp, rounded);
    if (copy_ != kNoSlot) row[copy_] = static_cast<double>(stamp) * 1e-9;
    return result;
  }

 private:
  MessageTypes types_;
  std::string type_;
  std::vector<std::byte> example_;
  CompileOptions options_;
  CompiledMessage compiled_;
  MessageProgram program_;
  std::uint32_t copy_ = kNoSlot;
};

// A fixed number of bytes can tell versions of a type from each other.
DecoderOrReason decoder_of_versions(const std::vector<MessageTypes>& versions,
                                    const MessageFormat& format,
                                    Wire wire) {
  DecoderOrReason result;
  for (const MessageTypes& types : versions) {
    auto decoder = std::make_unique<CompiledDecoder>(
        types, plain_type_name(format.type), wire, format.example);
    if (!decoder->problem().empty()) {
      result.why_not = decoder->problem();
    } else if (!decoder->fits()) {
      result.why_not = "its messages do not fit their definition";
    } else if (decoder->fields().empty()) {
      result.why_not = decoder->oversized() ? "arrays of more than 64 numbers" : "no numbers";
    } else {
      result.decoder = std::move(decoder);
      result.why_not.clear();
      return result;
    }
  }
  return result;
}

DecoderOrReason compiled_decoder(const MessageFormat& format, Wire wire) {
  const bool ros1 = wire == Wire::ros1;
  const bool readable =
      ros1 ? format.definition_encoding == "ros1msg" : format.definition_encoding == "ros2msg";
  const bool said = !format.definition_encoding.empty() && !format.definition.empty();
  if (said && !readable)
    return {nullptr,
            fmt::format("its definition is in {}", printable(format.definition_encoding, 40))};
  if (said) {
    MessageTypes types;
    std::string problem = add_message_types(format.type, format.definition, ros1, types);
    if (!problem.empty()) return {nullptr, std::move(problem)};
    complete_types(types);
    return decoder_of_versions({types}, format, wire);
  }
  const auto versions =
      ros1 ? std::vector<MessageTypes>{} : known_definitions(plain_type_name(format.type));
  if (versions.empty()) return {nullptr, "the log has no definition of this type"};
  return decoder_of_versions(versions, format, wire);
}

}  // namespace

DecoderOrReason make_decoder(const MessageFormat& format) {
  if (const auto why = no_numbers_of(plain_type_name(format.type)); !why.empty())
    return {nullptr, std::string(why)};
  if (format.message_encoding == "json") return json_decoder(format);
  if (format.message_encoding == "ros1") return compiled_decoder(format, Wire::ros1);
  if (format.message_encoding != "cdr")
    return {nullptr, fmt::format("encoding {}", printable(format.message_encoding, 40))};
  Wire wire = Wire::cdr;
  if (!format.example.empty()) {
    const Encapsulation found = read_encapsulation(format.example);
    if (!found.known) return {nullptr, "an encapsulation of CDR that is not read"};
    wire = found.wire;
  }
  return compiled_decoder(format, wire);
}

}  // namespace libchar

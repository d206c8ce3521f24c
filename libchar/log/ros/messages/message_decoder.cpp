#include "libchar/log/ros/messages/message_decoder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/log/ros/messages/message_definition.hpp"

namespace libchar {
namespace {

// Messages that are JSON documents: every number in them is a field ("angular_velocity.x", "data[2]").

using Sax = nlohmann::json_sax<nlohmann::json>;

constexpr std::size_t kDeepestJson = 32;

// Calls `number` with the name and value of every number. Goes through the text once and keeps
// nothing but the way to where it is.
class NumberSax final : public Sax {
 public:
  using Number = std::function<void(const std::string& name, double value)>;
  NumberSax(Number number) : number_(std::move(number)) {}

  bool null() override { return value(kMissing); }
  bool boolean(bool truth) override { return value(truth ? 1 : 0); }
  bool number_integer(number_integer_t n) override { return value(static_cast<double>(n)); }
  bool number_unsigned(number_unsigned_t n) override { return value(static_cast<double>(n)); }
  bool number_float(number_float_t x, const string_t&) override { return value(x); }
  bool string(string_t&) override { return pass(); }
  bool binary(binary_t&) override { return pass(); }
  bool start_object(std::size_t) override { return enter(false); }
  bool start_array(std::size_t) override { return enter(true); }
  bool key(string_t& name) override {
    Level& level = levels_.back();
    path_.resize(level.begin);
    if (!path_.empty()) path_ += '.';
    path_ += name;
    return path_.size() < 4096;
  }
  bool end_object() override { return leave(); }
  bool end_array() override { return leave(); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

 private:
  struct Level {
    std::size_t begin;  // of the path in front of this level's part
    bool array;
    std::size_t next = 0;
  };

  // The path of an element of an array is made when it comes.
  void name_element() {
    if (levels_.empty() || !levels_.back().array) return;
    Level& level = levels_.back();
    path_.resize(level.begin);
    path_ += fmt::format("[{}]", level.next++);
  }
  bool value(double x) {
    name_element();
    number_(path_, x);
    return true;
  }
  bool pass() {
    name_element();
    return true;
  }
  bool enter(bool array) {
    name_element();
    levels_.push_back({path_.size(), array});
    return levels_.size() <= kDeepestJson;
  }
  bool leave() {
    path_.resize(levels_.back().begin);
    levels_.pop_back();
    return true;
  }

  Number number_;
  std::string path_;
  std::vector<Level> levels_;
};

bool go_through(std::span<const std::byte> message, NumberSax::Number number) {
  const auto* text = reinterpret_cast<const char*>(message.data());
  NumberSax sax(std::move(number));
  return nlohmann::json::sax_parse(text, text + message.size(), &sax);
}

class JsonDecoder final : public MessageDecoder {
 public:
  explicit JsonDecoder(const MessageFormat& format) {
    std::map<std::string, std::size_t> lengths;
    valid_ = go_through(format.example, [&](const std::string& name, double) {
      const std::size_t bracket = name.rfind('[');
      if (bracket != std::string::npos && ++lengths[name.substr(0, bracket)] > kListedElements) {
        oversized_ = true;
        return;
      }
      if (fields_.size() >= kMostNumbers) {
        oversized_ = true;
        return;
      }
      const std::size_t dot = std::min(name.find_first_of(".["), name.size());
      const KnownMember known = known_member(plain_type_name(format.type), std::string_view(name).substr(0, dot));
      fields_.push_back({name, known.unit, Primitive::f64, known.usual});
    });
    if (oversized_) drop_long_arrays(lengths);
    find_stamp();
  }

  bool valid() const { return valid_; }
  const std::vector<NumberField>& fields() const override { return fields_; }
  std::optional<std::size_t> stamp() const override { return stamp_; }
  bool oversized() const override { return oversized_; }

  void select(const std::vector<std::size_t>& fields, std::optional<std::size_t> stamp) override {
    slots_.clear();
    for (std::size_t i = 0; i < fields.size(); ++i) slots_[fields_[fields[i]].name] = i;
    seconds_.clear();
    nanoseconds_.clear();
    if (!stamp) return;
    seconds_ = fields_[*stamp].name;
    if (stamp == stamp_ && stamp_nanoseconds_) nanoseconds_ = fields_[*stamp_nanoseconds_].name;
  }

  Decoded decode(std::span<const std::byte> message, std::span<double> row, std::int64_t& stamp,
                 std::uint64_t&) override {
    std::fill(row.begin(), row.end(), kMissing);
    double seconds = kMissing, nanoseconds = 0;
    const bool well = go_through(message, [&](const std::string& name, double value) {
      if (const auto found = slots_.find(name); found != slots_.end()) row[found->second] = value;
      if (name == seconds_) seconds = value;
      if (name == nanoseconds_) nanoseconds = value;
    });
    if (!well) return Decoded::misfit;
    if (seconds_.empty()) return Decoded::well;
    if (!(std::abs(seconds) < 9e9) || !(std::abs(nanoseconds) < 9e18)) return Decoded::misfit;
    const double whole = std::trunc(seconds);
    stamp = static_cast<std::int64_t>(whole) * 1000000000 +
            clamped_whole<std::int64_t>(std::round((seconds - whole) * 1e9)) + static_cast<std::int64_t>(nanoseconds);
    return Decoded::well;
  }

 private:
  void drop_long_arrays(const std::map<std::string, std::size_t>& lengths) {
    std::erase_if(fields_, [&](const NumberField& field) {
      const auto found = lengths.find(field.name.substr(0, field.name.rfind('[')));
      return field.name.ends_with(']') && found != lengths.end() && found->second > kListedElements;
    });
  }

  void find_stamp() {
    for (const char* front : {"header.stamp.", "timestamp.", "stamp.", "header.timestamp."})
      for (const char* second : {"sec", "secs", "seconds"}) {
        const auto seconds = find(std::string(front) + second);
        if (!seconds || stamp_) continue;
        stamp_ = seconds;
        for (const char* nanosecond : {"nsec", "nanosec", "nsecs", "nanos", "nanoseconds"})
          if (const auto nanos = find(std::string(front) + nanosecond)) stamp_nanoseconds_ = nanos;
        for (NumberField& field : fields_)
          if (field.name.starts_with(front)) field.usual = false;
      }
  }

  std::optional<std::size_t> find(const std::string& name) const {
    for (std::size_t i = 0; i < fields_.size(); ++i)
      if (fields_[i].name == name) return i;
    return std::nullopt;
  }

  std::vector<NumberField> fields_;
  std::optional<std::size_t> stamp_, stamp_nanoseconds_;
  bool oversized_ = false, valid_ = false;
  std::map<std::string, std::size_t> slots_;
  std::string seconds_, nanoseconds_;
};

// The fields are those of the example; without one there is a reason.
DecoderOrReason json_decoder(const MessageFormat& format) {
  if (format.example.empty()) return {nullptr, "no message to see its fields in"};
  auto decoder = std::make_unique<JsonDecoder>(format);
  if (!decoder->valid()) return {nullptr, "its messages are not JSON"};
  if (decoder->fields().empty()) return {nullptr, "no numbers"};
  return {std::move(decoder), ""};
}

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
    for (std::size_t i = 0; i < fields.size(); ++i) options_.slots[fields[i]] = static_cast<std::uint32_t>(i);
    copy_ = kNoSlot;
    if (stamp) {
      // A field may be both a channel and the time: the channel is then made of the stamp.
      copy_ = options_.slots[*stamp];
      options_.slots[*stamp] = kStampSlot;
    }
    program_ = compile_message(types_, type_, options_).program;
    options_.slots.clear();
  }

  Decoded decode(std::span<const std::byte> message, std::span<double> row, std::int64_t& stamp,
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
DecoderOrReason decoder_of_versions(const std::vector<MessageTypes>& versions, const MessageFormat& format, Wire wire) {
  DecoderOrReason result;
  for (const MessageTypes& types : versions) {
    auto decoder = std::make_unique<CompiledDecoder>(types, plain_type_name(format.type), wire, format.example);
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
  const bool readable = ros1 ? format.definition_encoding == "ros1msg" : format.definition_encoding == "ros2msg";
  const bool said = !format.definition_encoding.empty() && !format.definition.empty();
  if (said && !readable)
    return {nullptr, fmt::format("its definition is in {}", printable(format.definition_encoding, 40))};
  if (said) {
    MessageTypes types;
    std::string problem = add_message_types(format.type, format.definition, ros1, types);
    if (!problem.empty()) return {nullptr, std::move(problem)};
    complete_types(types);
    return decoder_of_versions({types}, format, wire);
  }
  const auto versions = ros1 ? std::vector<MessageTypes>{} : known_definitions(plain_type_name(format.type));
  if (versions.empty()) return {nullptr, std::string(kNoDefinition)};
  return decoder_of_versions(versions, format, wire);
}

}  // namespace

DecoderOrReason make_decoder(const MessageFormat& format) {
  if (const auto why = no_numbers_of(plain_type_name(format.type)); !why.empty()) return {nullptr, std::string(why)};
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

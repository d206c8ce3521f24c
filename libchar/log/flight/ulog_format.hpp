#pragma once
// Formats of ULog messages: "name:type field;type[n] field;…", nested in each other, as flat lists
// of numbers at their bytes.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/log/binary/file.hpp"
#include "libchar/log/binary/number_type.hpp"
#include "libchar/log/flight/ulog_walk.hpp"

namespace libchar {

// The beginning of a ULog file: is it one, can it be read, and which stretches of it hold messages.

struct UlogHeader {
  int version = 0;
  std::vector<UlogStretch> stretches;  ///< the log, then what was appended
};

/// Do the first bytes say ULog, or ULog that is encrypted?
bool is_ulog(std::string_view first_bytes);

/// Throws Error(input) for what is no ULog (E0480), is encrypted (E0481) or needs what this reader lacks (E0482).
UlogHeader read_ulog_header(const BinaryFile& file, Findings& warnings);

/// What an information message says, as text: the value of a char array, or a version of four bytes
/// as "v1.14.3"; "" for others.
struct UlogInfo {
  std::string key, value;
};
UlogInfo read_ulog_info(std::span<const std::byte> body);

struct UlogField {
  std::string name;  ///< "x", "delta_angle[2]", "esc[0].rpm"
  NumberType type = NumberType::u8;
  std::uint32_t byte = 0;  ///< where it stands in a message of data, behind the message's id
};

struct UlogLayout {
  std::vector<UlogField> fields;  ///< the numbers, without padding and text
  std::uint32_t bytes = 0;        ///< of a whole message
  std::uint32_t least_bytes = 0;  ///< without the padding at its end, which writers leave out
  std::string why_not;            ///< why the format cannot be used; "" when it can
};

class UlogFormats {
 public:
  /// Takes the text of one definition. One that contradicts an earlier one of its name makes that name unusable.
  void add(std::string_view text);

  /// The fields of a message of this format. All layouts together have a bound, so that a small
  /// file cannot ask for endless work.
  UlogLayout layout(const std::string& name);

  /// Was a name defined twice, and not alike?
  bool contradicted() const { return contradicted_; }

 private:
  struct Member {
    std::string type, name;
    std::uint32_t count = 1;
    bool array = false;
  };
  struct Definition {
    std::string text;
    std::vector<Member> members;
    std::string why_not;
  };
  static bool parse_member(std::string_view text, Member& member);
  std::string flatten(const std::string& format, const std::string& prefix, int depth, UlogLayout& out);
  std::string flatten_member(const Member& member, const std::string& prefix, int depth, UlogLayout& out);

  std::map<std::string, Definition, std::less<>> definitions_;
  bool contradicted_ = false;
  std::uint64_t fields_ = 0, steps_ = 0;  // of all layouts
};

// What PX4's messages of sensors hold: a ULog names types and fields, but no units.
// Source: the comments of PX4's message definitions (msg/*.msg), from version 1.4 to 1.16.

/// The unit of a field ("rad/s"), nothing where it is not known; `field` as in its own message and
/// without an index ("gyro_rad").
std::optional<std::string_view> px4_unit(std::string_view message, std::string_view field);

/// Is this a message that a sensor's driver, or what merges several, writes?
bool px4_sensor(std::string_view message);

/// Stamps, identities, counters, flags: what is no sample whatever the message ("device_id", "error_count").
bool px4_no_sample(std::string_view field);

}  // namespace libchar

#pragma once
// Formats of DataFlash messages: FMT says letters and labels, FMTU, UNIT and MULT what the numbers mean.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/log/binary/file.hpp"
#include "libchar/log/binary/number_type.hpp"

namespace libchar {

inline constexpr std::uint8_t kDataflashFmt = 128;       // the type of FMT
inline constexpr std::uint8_t kDataflashFmtLength = 89;  // of the whole message
inline constexpr std::size_t kDataflashFront = 3;        // two magic bytes and the type
inline constexpr std::size_t kDataflashArray = 32;       // numbers of an array ('a')

struct DataflashField {
  std::string name;
  char letter = 0;
  NumberType type = NumberType::u8;
  std::size_t position = 0;        ///< among the letters of the format
  std::uint32_t byte = 0;          ///< in the message, behind its front
  bool text = false;               ///< no number
  bool array = false;              ///< kDataflashArray numbers
  double factor = 1, divisor = 1;  ///< value = number · factor / divisor
  std::string unit;
};

/// What a message is for: data, or a description of others.
enum class DataflashRole { data, units_of_kind, unit, multiplier };

/// One definition, which messages of its type follow until another one is given.
struct DataflashKind {
  std::uint8_t type = 0, length = 0;
  std::string name, format;
  DataflashRole role = DataflashRole::data;
  std::vector<DataflashField> fields;
  std::string why_not;                  ///< why its messages cannot be read; "" when they can
  std::optional<std::size_t> instance;  ///< the field that tells sensors of one kind apart

  const DataflashField* find(std::string_view name, char letter) const;
};

/// A text in a fixed number of bytes, filled up by NUL.
std::string dataflash_text(std::span<const std::byte> bytes);

/// Does this look like the body of a FMT message?
bool is_dataflash_fmt(std::span<const std::byte> body);

class DataflashFormats {
 public:
  DataflashFormats();

  /// Forgets which definitions hold at the moment, and keeps them and their units: before the file is read again.
  void rewind();

  /// Takes the body of a FMT, FMTU, UNIT or MULT; false for other messages.
  bool take(std::uint8_t type, std::span<const std::byte> body);

  /// Length of a whole message of this type, 0 when the log has not defined it.
  std::size_t length(std::uint8_t type) const { return lengths_[type]; }

  /// The definition that messages of this type follow now.
  std::optional<std::size_t> kind_of(std::uint8_t type) const { return current_[type]; }
  const DataflashKind& kind(std::size_t index) const { return kinds_[index]; }

  /// Did a FMTU come behind messages that it would have told apart?
  bool changed_behind() const { return changed_behind_; }
  void note_used(std::size_t kind) { used_[kind] = true; }

  /// Applies units and multipliers to the fields. Called once all are known.
  void apply_units();

  /// Fields whose letter and multiplier say different scales ("CTUN.Alt"): the multiplier is taken.
  const std::vector<std::string>& contradictions() const { return contradictions_; }

 private:
  void define(std::span<const std::byte> body);
  void take_units(const DataflashKind& kind, std::span<const std::byte> body);
  void take_unit(const DataflashKind& kind, std::span<const std::byte> body);
  void take_multiplier(const DataflashKind& kind, std::span<const std::byte> body);
  void apply_units(DataflashKind& kind, const std::string& units, const std::string& multipliers);

  struct Meaning {
    std::string units, multipliers;  ///< a letter a field
  };

  std::vector<DataflashKind> kinds_;
  std::vector<bool> used_;
  std::map<std::string, std::size_t> kind_of_definition_;
  std::array<std::optional<std::size_t>, 256> current_{};
  std::array<std::uint8_t, 256> lengths_{};
  std::map<std::size_t, Meaning> meanings_;
  std::map<char, std::string> units_;
  std::map<char, double> multipliers_;
  std::vector<std::string> contradictions_;
  bool changed_behind_ = false;
};

// The messages of a DataFlash log one after the other, and what to do where bytes are damaged or missing.

struct DataflashMessage {
  std::uint64_t byte = 0;  ///< where it begins
  std::uint8_t type = 0;
  std::span<const std::byte> body;  ///< behind its front; valid until the next message is asked for
};

class DataflashWalk {
 public:
  /// `formats` is looked at while messages are read: lengths are added as definitions come. Damage
  /// is counted in `losses`.
  DataflashWalk(const BinaryFile& file, std::size_t block_bytes, const DataflashFormats& formats, Findings& losses);

  bool next(DataflashMessage& message);
  std::uint64_t position() const { return position_; }

 private:
  bool is_front(std::uint64_t byte);
  std::size_t whole_length(std::uint64_t byte);
  bool cut_by_end(std::uint64_t byte);
  bool well_followed(std::uint64_t byte);
  std::uint64_t next_good(std::uint64_t byte);
  void pass_over_damage();

  FileWindow window_;
  std::uint64_t position_ = 0, end_ = 0, fill_ = 0;
  const DataflashFormats* formats_;
  Findings* losses_;
};

// What ArduPilot's messages of sensors hold, where a log does not say it itself (FMTU came in 2018).
// Source: ArduPilot's libraries/AP_Logger/LogStructure.h and those of its sensors.

/// Is this a message that a sensor's driver writes ("GYR", "IMU2", "BARO")?
bool dataflash_sensor(std::string_view message);

/// Offsets, counters, health: what is no sample of a sensor.
bool dataflash_no_sample(std::string_view field);

}  // namespace libchar

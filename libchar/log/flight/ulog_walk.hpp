#pragma once
// The messages of a ULog file one after the other: framing, appended stretches, and what to do
// where bytes are damaged or missing.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/log/binary/file.hpp"

namespace libchar {

inline constexpr std::uint64_t kUlogHeader = 16;  // bytes before the first message

/// What a message of data may measure, by its id: a size that does not fit is how damage is found.
struct UlogSizes {
  bool known = false;
  std::uint32_t least = 0, most = 0xffffffff;  ///< bytes behind the id
};

struct UlogMessage {
  std::uint64_t byte = 0;  ///< where it begins
  char type = 0;
  std::span<const std::byte> body;  ///< valid until the next message is asked for
};

/// A stretch of the file that messages fill: the log itself, and what was appended to it after a crash.
struct UlogStretch {
  std::uint64_t first = 0, end = 0;
};

class UlogWalk {
 public:
  /// `sizes` is looked at while messages are read: entries are added as subscriptions come. Damage
  /// is counted in `losses`.
  UlogWalk(const BinaryFile& file, std::size_t block_bytes, std::vector<UlogStretch> stretches,
           const std::vector<UlogSizes>& sizes, Findings& losses);

  /// Reading goes on with the message that begins at this byte.
  void go_to(std::uint64_t byte);
  bool next(UlogMessage& message);
  std::uint64_t position() const { return position_; }

 private:
  enum class Sight { sure, maybe, no };
  Sight look(std::uint64_t byte);
  Sight look_at_data(std::uint64_t byte, std::uint32_t size);
  Sight look_at_text(std::uint64_t byte, std::uint32_t size, char type);
  std::uint64_t behind(std::uint64_t byte) { return byte + 3 + little_endian<2>(window_.at(byte, 3)); }
  bool cut_by_end(std::uint64_t byte);
  bool good(std::uint64_t byte);
  bool believed(std::uint64_t byte);
  std::uint64_t next_good(std::uint64_t byte);
  void pass_over_damage();
  void skip_to_stretch();

  FileWindow window_;
  std::vector<UlogStretch> stretches_;
  std::size_t stretch_ = 0;
  std::uint64_t position_ = 0, end_ = 0;
  std::uint64_t known_good_ = 0;  // the message of this byte has been looked at
  const std::vector<UlogSizes>* sizes_;
  Findings* losses_;
};

}  // namespace libchar

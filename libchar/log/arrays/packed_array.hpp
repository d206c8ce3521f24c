#pragma once
// Rows of an array whose elements stand in packed bytes: what .npz and MATLAB files have in common.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libchar/log/arrays/log_array.hpp"
#include "libchar/log/binary/file.hpp"

namespace libchar {

// Bytes of a stretch of a file in their order, inflated where they are compressed: members of ZIP
// archives, elements of MATLAB files.

enum class Packing {
  stored,
  deflate,  ///< RFC 1951, as in ZIP
  zlib,     ///< RFC 1950, as in MATLAB files
};

/// A stretch of a file.
struct PackedStretch {
  std::uint64_t first_byte = 0;
  std::uint64_t packed_bytes = 0;  ///< in the file
  std::uint64_t bytes = 0;         ///< unpacked, the most that is given out
  Packing packing = Packing::stored;
};

/// No output of deflate is longer than this many times its input (258 bytes from 2 bits).
inline constexpr std::uint64_t kDeflateRatio = 1032;

/// Throws Error(input) where what is compressed is broken (E0462) or zlib is not built in (E0467).
class PackedBytes {
 public:
  /// `name` stands in messages; the file must outlive this.
  PackedBytes(const BinaryFile& file, PackedStretch stretch, std::string name);
  ~PackedBytes();
  PackedBytes(const PackedBytes&) = delete;
  PackedBytes& operator=(const PackedBytes&) = delete;
  /// The next to.size() bytes, all of them.
  void read(std::span<std::byte> to);
  void skip(std::uint64_t count);
  /// To the end of what is compressed, where its own checksum stands; no further reading.
  void drain();
  /// CRC-32 of all that was read (of what was skipped only where it was compressed).
  std::uint32_t crc() const { return crc_; }
  std::uint64_t position() const { return position_; }       ///< bytes given out or skipped
  std::uint64_t packed_position() const { return packed_; }  ///< bytes of the file consumed

 private:
  struct Inflater;
  [[noreturn]] void refuse(std::string what) const;
  bool inflate_into(std::span<std::byte> to, bool may_end);  // false at the end of the stream

  const BinaryFile& file_;
  PackedStretch stretch_;
  std::string name_;
  std::uint64_t position_ = 0, packed_ = 0;
  std::uint32_t crc_ = 0;
  std::unique_ptr<Inflater> inflater_;
};

struct PackedArray {
  PackedStretch stretch;
  std::string name;             ///< for messages
  std::uint64_t data_byte = 0;  ///< of the first element, in the unpacked bytes
  std::uint64_t element_bytes = 0;
  std::optional<std::uint32_t> crc;  ///< of all unpacked bytes
  bool to_the_end = false;  ///< the elements are the last of a compressed stream, which ends in a checksum of its own
};

/// `file` and `consumed`, to which bytes of the file are added, outlive the cursor. Rows come in
/// constant memory in either order; columns that stand one after the other are inflated once for
/// each. Throws Error(input) E0462 for broken data.
std::unique_ptr<ArrayCursor> open_packed_array(const BinaryFile& file, const PackedArray& array, const ArrayRows& rows,
                                               const std::vector<std::uint64_t>& columns, std::uint64_t& consumed);

}  // namespace libchar

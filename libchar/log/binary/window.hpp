#pragma once
// A binary file read from front to end through one buffer: any few bytes of it stand together in
// memory, and no more of it does.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libchar/log/binary/file.hpp"

namespace libchar {

class FileWindow {
 public:
  /// `block_bytes` are read at a time (more where a piece is longer), and `kept` bytes in front of
  /// them: who looks ahead by less than that and comes back reads nothing twice.
  FileWindow(const BinaryFile& file, std::size_t block_bytes, std::size_t kept)
      : file_(&file), block_(block_bytes == 0 ? 1 : block_bytes), kept_(kept) {}

  /// `count` bytes from `byte` on, valid until the next call; nullptr when the file ends before.
  const std::byte* at(std::uint64_t byte, std::size_t count) {
    if (byte >= first_ && byte - first_ <= bytes_.size() &&
        count <= bytes_.size() - static_cast<std::size_t>(byte - first_))
      return bytes_.data() + (byte - first_);
    return load(byte, count);
  }

 private:
  const std::byte* load(std::uint64_t byte, std::size_t count);

  const BinaryFile* file_;
  std::size_t block_, kept_;
  std::uint64_t first_ = 0;
  std::vector<std::byte> bytes_;
};

/// A little-endian number of Bytes bytes.
template <std::size_t Bytes>
std::uint64_t little_endian(const std::byte* first) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < Bytes; ++i)
    value |= static_cast<std::uint64_t>(std::to_integer<std::uint8_t>(first[i])) << (8 * i);
  return value;
}

}  // namespace libchar

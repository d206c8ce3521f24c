#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <future>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace libchar {

/// A regular file opened for reading, with bounds: nothing is ever mapped (a file cut short by
/// others would kill the process).
class BinaryFile {
 public:
  explicit BinaryFile(std::string path);
  ~BinaryFile();
  BinaryFile(const BinaryFile&) = delete;
  BinaryFile& operator=(const BinaryFile&) = delete;
  /// Fills `to` from `offset`. Throws Error(input) when the file ends before.
  void read(std::uint64_t offset, std::span<std::byte> to) const;
  /// The first `count` bytes, or all there are.
  std::string head(std::size_t count) const;
  const std::string& path() const { return path_; }
  std::uint64_t size() const { return size_; }

 private:
  std::string path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

// What to say of a file that does not begin with the mark of its format: one that was cut there is
// no file of another format.

/// Why `found`, the first bytes of a file, are not `mark`, in words: empty, cut inside the mark, or
/// not like `what` ("a bag").
std::string wrong_start(std::string_view found, std::string_view mark, std::string_view what);

// The digest of a whole file in its own order, taken beside the reading of it, from pages that the system has cached.

class FileHash {
 public:
  /// The file outlives this. Nothing is hashed unless `wanted`.
  FileHash(const BinaryFile& file, bool wanted) : files_({&file}), wanted_(wanted) {}
  /// Of several files as if they were one.
  FileHash(std::vector<const BinaryFile*> files, bool wanted) : files_(std::move(files)), wanted_(wanted) {}
  /// An abandoned reading does not finish the hash of a large file.
  ~FileHash();
  FileHash(const FileHash&) = delete;
  FileHash& operator=(const FileHash&) = delete;

  /// Begins beside the caller, once; a thread that is not to be had means: in `finish`.
  void start();
  /// 64 hexadecimal digits, "" when not wanted. Waits for what is left.
  std::string finish();

 private:
  std::string digest_of_files() const;

  std::vector<const BinaryFile*> files_;
  bool wanted_;
  std::atomic<bool> stop_ = false;
  std::string digest_;
  std::future<std::string> hashing_;
};

// A binary file read from front to end through one buffer: any few bytes of it stand together in
// memory, and no more of it does.

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

#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

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

}  // namespace libchar

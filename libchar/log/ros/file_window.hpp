#pragma once
// A stretch of a file in memory that moves with the reading.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libchar/log/binary/file.hpp"

namespace libchar {

class MovingWindow {
 public:
  explicit MovingWindow(const std::string& path) : file_(path) {}
  std::uint64_t size() const { return file_.size(); }
  const std::string& path() const { return file_.path(); }
  /// Bytes behind `at`, 0 beyond the end.
  std::uint64_t left(std::uint64_t at) const { return at < size() ? size() - at : 0; }
  /// `count` bytes from `at` on, all inside the file; valid until the next call. Whoever asks has looked at `left`.
  std::span<const std::byte> view(std::uint64_t at, std::size_t count);

 private:
  static constexpr std::size_t kWindow = std::size_t{1} << 20U;
  BinaryFile file_;
  std::vector<std::byte> buffer_;
  std::uint64_t begin_ = 0;
  std::size_t filled_ = 0;
};

}  // namespace libchar

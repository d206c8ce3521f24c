#pragma once
// A stretch of a file in memory that moves with the reading.

#include <cstddef>
#include <cstdint>
#include <cstring>
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

/// Little-endian fields one after the other. What is not there reads as 0 and is remembered.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  bool good() const { return good_; }
  std::size_t at() const { return at_; }
  std::size_t left() const { return bytes_.size() - at_; }

  template <typename T>
  T number() {
    T value{};
    const auto from = take(sizeof value);
    if (!from.empty()) std::memcpy(&value, from.data(), sizeof value);
    return value;
  }
  /// A text with its length (u32) in front.
  std::string text() {
    const auto from = take(number<std::uint32_t>());
    return {reinterpret_cast<const char*>(from.data()), from.size()};
  }
  std::span<const std::byte> take(std::uint64_t count) {
    if (count > left()) {
      good_ = false;
      at_ = bytes_.size();
      return {};
    }
    const auto part = bytes_.subspan(at_, static_cast<std::size_t>(count));
    at_ += static_cast<std::size_t>(count);
    return part;
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

}  // namespace libchar

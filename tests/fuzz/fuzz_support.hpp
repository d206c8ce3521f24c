#pragma once
// What the fuzz targets share: an input cut into pieces, and the ways to fail that libFuzzer keeps an input for.

#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "libchar/core/error.hpp"

namespace fuzz {

/// Prints what differs and aborts.
[[noreturn]] inline void fail(const char* what, const std::string& a, const std::string& b) {
  std::fprintf(stderr, "%s:\n%s\n--\n%s\n", what, a.c_str(), b.c_str());
  std::abort();
}
inline void expect_same(const char* what, const std::string& a, const std::string& b) {
  if (a != b) fail(what, a, b);
}
inline void expect(bool holds, const char* what) {
  if (!holds) fail(what, "", "");
}

/// A refusal is one line. What the program itself would call an internal error is any other
/// exception, which ends the target.
inline std::string said(const libchar::Error& error) {
  const std::string text = error.what();
  expect(text.find('\n') == std::string::npos, "a refusal in several lines");
  return text;
}

/// Bytes handed out from the front; zeros when there are no more.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(reinterpret_cast<const char*>(data), size) {}
  std::uint8_t byte() { return take<std::uint8_t>(); }
  template <class Number>
  Number take() {
    Number number{};
    const std::size_t n = std::min(sizeof number, rest_.size());
    std::memcpy(&number, rest_.data(), n);
    rest_.remove_prefix(n);
    return number;
  }
  bool empty() const { return rest_.empty(); }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

/// A document that is read, written, and read back to the same text. `read_and_write(text, file)`
/// gives what is written.
template <class Function>
void round_trip(const std::uint8_t* data, std::size_t size, Function read_and_write) {
  if (size == 0) return;
  const bool json = data[0] % 2 == 1;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  std::string written, again;
  try {
    written = read_and_write(text, json ? "document.json" : "document.yaml");
  } catch (const libchar::Error& error) {
    said(error);
    return;
  }
  try {
    again = read_and_write(written, "document.yaml");
  } catch (const libchar::Error& error) {
    again = error.what();
  }
  expect_same("written, and written again from what was written", written, again);
}

inline std::string bits(double value) { return std::to_string(std::bit_cast<std::uint64_t>(value)); }

}  // namespace fuzz

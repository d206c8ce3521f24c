#pragma once
// std::from_chars and std::to_chars of double, on every platform: with a C++ library that lacks them (a web page's) by
// fast_float and fmt, to the same values and characters.

#include <charconv>

namespace libchar::detail {

#if defined(__cpp_lib_to_chars) && !defined(LIBCHAR_SERIAL)
inline std::from_chars_result read_double(const char* first, const char* last, double& value) {
  return std::from_chars(first, last, value);
}
inline std::to_chars_result write_double(char* first, char* last, double value) {
  return std::to_chars(first, last, value);
}
#else
/// General notation. Out of range, which includes what rounds to zero without being zero: `value` stays.
std::from_chars_result read_double(const char* first, const char* last, double& value);
/// Shortest digits that read back; fixed where that is not longer than scientific notation.
std::to_chars_result write_double(char* first, char* last, double value);
#endif

}  // namespace libchar::detail

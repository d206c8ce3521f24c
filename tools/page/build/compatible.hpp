// Included in front of every source of the page: what Debian 12's C++ library for WebAssembly (13) lacks of C++20.
#pragma once
#include <algorithm>
#include <bit>
#include <iterator>
#include <memory>
#include <type_traits>
#include <version>

namespace std {
#if !defined(__cpp_lib_bit_cast)
template <class To, class From>
requires(sizeof(To) == sizeof(From) && is_trivially_copyable_v<To> && is_trivially_copyable_v<From>) constexpr To
    bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}
#endif
#if !defined(__cpp_lib_smart_ptr_for_overwrite)
template <class Array>
requires(is_unbounded_array_v<Array>) unique_ptr<Array> make_unique_for_overwrite(size_t count) {
  return unique_ptr<Array>(new remove_extent_t<Array>[count]);
}
#endif
#if !defined(__cpp_lib_ranges)
namespace ranges {
template <class Range, class Out>
void move(Range&& range, Out out) {
  for (auto& value : range) *out++ = std::move(value);
}
}  // namespace ranges
#endif
}  // namespace std

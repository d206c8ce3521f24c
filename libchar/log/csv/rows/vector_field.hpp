#pragma once
// One decimal number without exponent from text, by AVX2.
//
// A field -?D*.D* of at most 16 characters behind the sign becomes an integer m of its digits and
// f, the number of digits behind the point; m < 2^53 and 10^f <= 10^15 are exact doubles, so m /
// 10^f is rounded once (Clinger 1990, fast path).

#include <array>
#include <cstddef>
#include <cstdint>

#include "libchar/core/process/processor.hpp"

#if defined(LIBCHAR_X86_64)
#include <immintrin.h>

#define LIBCHAR_AVX2_INLINE __attribute__((LIBCHAR_AVX2, always_inline))

namespace libchar::vector_parsing {

inline constexpr std::array<double, 17> kPowers = {1,   1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7, 1e8,
                                                   1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16};
inline constexpr std::array<std::int64_t, 10> kIntegerPowers = {1,      10,      100,      1000,      10000,
                                                                100000, 1000000, 10000000, 100000000, 1000000000};
inline constexpr std::int64_t kExactInteger = std::int64_t{1} << 53U;

// gather[point][length] moves the digits of a field, without its point, to the right end of 16
// bytes; 0x80 gives zero. Without a point: point = length. Of nothing it takes the separator
// behind, which is no digit. Lengths up to 31 may be asked for; beyond 16 the answer means nothing.
struct Gather {
  alignas(16) std::uint8_t index[32][32][16];
};

constexpr Gather make_gather() {
  Gather g{};
  for (unsigned point = 0; point <= 16; ++point)
    for (unsigned length = 0; length <= 16; ++length) {
      const unsigned digits = point < length ? length - 1 : length;
      unsigned to = 16 - digits;
      for (auto& byte : g.index[point][length]) byte = 0x80;
      for (unsigned from = 0; from < length; ++from)
        if (from != point || point >= length) g.index[point][length][to++] = static_cast<std::uint8_t>(from);
    }
  g.index[0][0][15] = 0;
  return g;
}

inline constexpr Gather kGather = make_gather();

// Constants of the vector code, as memory operands.
struct alignas(16) Bytes {
  std::uint8_t value[16];
};
consteval Bytes all(std::uint8_t byte) {
  Bytes bytes{};
  for (auto& b : bytes.value) b = byte;
  return bytes;
}
inline constexpr Bytes kPoint = all('.'), kZero = all('0'), kNine = all(9);
inline __m128i vector_of(const Bytes& bytes) { return _mm_load_si128(reinterpret_cast<const __m128i*>(bytes.value)); }

struct Field {
  std::int64_t digits = 0;   // all digits as one integer
  std::uint32_t behind = 0;  // how many of them stand behind the point
  bool regular = false;
};

LIBCHAR_AVX2_INLINE inline Field read_field(const char* text, std::uint32_t length) {
  const __m128i raw = _mm_loadu_si128(reinterpret_cast<const __m128i*>(text));
  const std::uint32_t inside = _bzhi_u32(0xFFFF, length);
  const std::uint32_t points =
      static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_cmpeq_epi8(raw, vector_of(kPoint)))) & inside;
  const __m128i digit = _mm_sub_epi8(raw, vector_of(kZero));
  const auto is_digit =
      static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_cmpeq_epi8(_mm_min_epu8(digit, vector_of(kNine)), digit)));
  Field field;
  // Branches that are never taken in a regular file are cheaper than one flag put together from four.
  if (__builtin_expect(length > 16 || ((is_digit | points) & inside) != inside || (points & (points - 1)) != 0 ||
                           (is_digit & inside) == 0 || (points != 0 && (points << 1U) > inside),
                       0))
    return field;
  field.regular = true;
  const std::uint32_t point = _tzcnt_u32(points | (std::uint32_t{1} << length));
  field.behind = length - point - static_cast<std::uint32_t>(points != 0);
  const __m128i packed =
      _mm_shuffle_epi8(digit, _mm_load_si128(reinterpret_cast<const __m128i*>(kGather.index[point][length])));
  const __m128i pairs =
      _mm_maddubs_epi16(packed, _mm_setr_epi8(10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1));
  const __m128i fours = _mm_madd_epi16(pairs, _mm_setr_epi16(100, 1, 100, 1, 100, 1, 100, 1));
  const __m128i words = _mm_packus_epi32(fours, fours);
  const __m128i eights = _mm_madd_epi16(words, _mm_setr_epi16(10000, 1, 10000, 1, 10000, 1, 10000, 1));
  const auto both = static_cast<std::uint64_t>(_mm_cvtsi128_si64(eights));
  field.digits = static_cast<std::int64_t>((both & 0xFFFFFFFFU) * 100000000U + (both >> 32U));
  return field;
}

/// The fields of one column over consecutive rows: field r lies between the separators at stops[r *
/// width - 1] (the byte before the text for the very first) and stops[r * width].
struct Column {
  const char* text;
  const std::uint32_t* stops;  // of all columns
  std::size_t width, index;
  char delimiter;
  bool crlf;
};

}  // namespace libchar::vector_parsing

#endif

#pragma once
// One decimal number without exponent from text, by AVX2 or by the vectors of WebAssembly.
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

#define LIBCHAR_VECTOR __attribute__((LIBCHAR_AVX2))
#define LIBCHAR_VECTOR_INLINE __attribute__((LIBCHAR_AVX2, always_inline))
#elif defined(LIBCHAR_WASM)
#include <wasm_simd128.h>

#define LIBCHAR_VECTOR
#define LIBCHAR_VECTOR_INLINE __attribute__((always_inline))
#endif

#if defined(LIBCHAR_VECTOR)

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

#if defined(LIBCHAR_X86_64)

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

using Sixteen = __m128i;
LIBCHAR_VECTOR_INLINE inline Sixteen sixteen_at(const void* bytes) {
  return _mm_loadu_si128(static_cast<const __m128i*>(bytes));
}
LIBCHAR_VECTOR_INLINE inline std::uint32_t points_of(Sixteen raw) {
  return static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_cmpeq_epi8(raw, vector_of(kPoint))));
}
LIBCHAR_VECTOR_INLINE inline Sixteen digits_of(Sixteen raw) { return _mm_sub_epi8(raw, vector_of(kZero)); }
LIBCHAR_VECTOR_INLINE inline std::uint32_t up_to_nine(Sixteen digit) {
  return static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_cmpeq_epi8(_mm_min_epu8(digit, vector_of(kNine)), digit)));
}
LIBCHAR_VECTOR_INLINE inline std::uint32_t first_bit(std::uint32_t bits) { return _tzcnt_u32(bits); }

/// The number that the bytes `index` of sixteen digits make: of its first eight in the low half, of the others in the
/// high one.
LIBCHAR_VECTOR_INLINE inline std::uint64_t two_eights(Sixteen digit, const std::uint8_t* index) {
  const __m128i packed = _mm_shuffle_epi8(digit, _mm_load_si128(reinterpret_cast<const __m128i*>(index)));
  const __m128i pairs =
      _mm_maddubs_epi16(packed, _mm_setr_epi8(10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1));
  const __m128i fours = _mm_madd_epi16(pairs, _mm_setr_epi16(100, 1, 100, 1, 100, 1, 100, 1));
  const __m128i words = _mm_packus_epi32(fours, fours);
  const __m128i eights = _mm_madd_epi16(words, _mm_setr_epi16(10000, 1, 10000, 1, 10000, 1, 10000, 1));
  return static_cast<std::uint64_t>(_mm_cvtsi128_si64(eights));
}

#else

using Sixteen = v128_t;
LIBCHAR_VECTOR_INLINE inline Sixteen sixteen_at(const void* bytes) { return wasm_v128_load(bytes); }
LIBCHAR_VECTOR_INLINE inline std::uint32_t points_of(Sixteen raw) {
  return wasm_i8x16_bitmask(wasm_i8x16_eq(raw, wasm_i8x16_const_splat('.')));
}
LIBCHAR_VECTOR_INLINE inline Sixteen digits_of(Sixteen raw) { return wasm_i8x16_sub(raw, wasm_i8x16_const_splat('0')); }
LIBCHAR_VECTOR_INLINE inline std::uint32_t up_to_nine(Sixteen digit) {
  return wasm_i8x16_bitmask(wasm_u8x16_le(digit, wasm_i8x16_const_splat(9)));
}
LIBCHAR_VECTOR_INLINE inline std::uint32_t first_bit(std::uint32_t bits) {
  return static_cast<std::uint32_t>(__builtin_ctz(bits));
}
LIBCHAR_VECTOR_INLINE inline std::uint64_t two_eights(Sixteen digit, const std::uint8_t* index) {
  const v128_t packed = wasm_i8x16_swizzle(digit, wasm_v128_load(index));
  const v128_t tens = wasm_i16x8_mul(wasm_v128_and(packed, wasm_i16x8_const_splat(0xFF)), wasm_i16x8_const_splat(10));
  const v128_t pairs = wasm_i16x8_add(tens, wasm_u16x8_shr(packed, 8));
  const v128_t fours = wasm_i32x4_dot_i16x8(pairs, wasm_i16x8_const(100, 1, 100, 1, 100, 1, 100, 1));
  const v128_t words = wasm_u16x8_narrow_i32x4(fours, fours);
  const v128_t eights = wasm_i32x4_dot_i16x8(words, wasm_i16x8_const(10000, 1, 10000, 1, 10000, 1, 10000, 1));
  return static_cast<std::uint64_t>(wasm_i64x2_extract_lane(eights, 0));
}

#endif

struct Field {
  std::int64_t digits = 0;   // all digits as one integer
  std::uint32_t behind = 0;  // how many of them stand behind the point
  bool regular = false;
};

LIBCHAR_VECTOR_INLINE inline Field read_field(const char* text, std::uint32_t length) {
  const Sixteen raw = sixteen_at(text);
  const std::uint32_t inside = (std::uint32_t{1} << (length & 31U)) - 1;
  const std::uint32_t points = points_of(raw) & inside;
  const Sixteen digit = digits_of(raw);
  const std::uint32_t is_digit = up_to_nine(digit);
  Field field;
  // Branches that are never taken in a regular file are cheaper than one flag put together from four.
  if (__builtin_expect(length > 16 || ((is_digit | points) & inside) != inside || (points & (points - 1)) != 0 ||
                           (is_digit & inside) == 0 || (points != 0 && (points << 1U) > inside),
                       0))
    return field;
  field.regular = true;
  const std::uint32_t point = first_bit(points | (std::uint32_t{1} << length));
  field.behind = length - point - static_cast<std::uint32_t>(points != 0);
  const std::uint64_t eights = two_eights(digit, kGather.index[point][length]);
  field.digits = static_cast<std::int64_t>((eights & 0xFFFFFFFFU) * 100000000U + (eights >> 32U));
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

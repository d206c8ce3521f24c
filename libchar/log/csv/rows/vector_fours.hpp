#pragma once
// Four decimal numbers without exponent at once, by AVX2.

#include "libchar/log/csv/rows/vector_field.hpp"

#if defined(LIBCHAR_X86_64)

namespace libchar::vector_parsing {

// What to divide by, by the distance from the point (or the end, when there is none) to the end: 10^(distance - 1);
// nothing good when the point stands last. From 32 on with a sign, which the quotient takes over.
inline constexpr auto kDivisors = [] {
  std::array<double, 64> table{};
  for (std::size_t distance = 0; distance < 32; ++distance) {
    const bool regular = distance == 0 || (distance >= 2 && distance <= 17);
    table[distance] = !regular ? __builtin_nan("") : distance == 0 ? 1 : kPowers[distance - 1];
    table[32 + distance] = -table[distance];
  }
  return table;
}();

LIBCHAR_VECTOR_INLINE inline __m256i both(const void* low, const void* high) {
  const __m128i first = _mm_loadu_si128(static_cast<const __m128i*>(low)),
                second = _mm_loadu_si128(static_cast<const __m128i*>(high));
  return _mm256_inserti128_si256(_mm256_castsi128_si256(first), second, 1);
}

// Where four fields of a column stand.
struct FourFields {
  const char* begin[4];  // behind the sign
  std::uint32_t length[4], sign[4];
  std::uint32_t foreign = 0;  // not 0 when a field does not end as it should
  std::int32_t room = 0;      // negative when a field has more than 16 characters
};

template <bool kLast>
LIBCHAR_VECTOR_INLINE inline void locate_fours(const Column& column, const std::uint32_t* stop, FourFields& at) {
  const char* const text = column.text;
  const std::uint32_t separator = static_cast<unsigned char>(kLast ? '\n' : column.delimiter);
  for (std::size_t k = 0; k < 4; ++k) {
    const std::uint32_t* const end = stop + k * column.width;
    const std::uint32_t from = end[-1] + 1;
    std::uint32_t to = *end;
    at.foreign |= static_cast<unsigned char>(text[to]) ^ separator;
    if (kLast && column.crlf) at.foreign |= static_cast<unsigned char>(text[--to]) ^ std::uint32_t{'\r'};
    at.sign[k] =
        ((static_cast<std::uint32_t>(static_cast<unsigned char>(text[from])) ^ std::uint32_t{'-'}) - 1U) >> 31U;
    at.begin[k] = text + from + at.sign[k];
    at.length[k] = to - from - at.sign[k];
    at.room |= 16 - static_cast<std::int32_t>(at.length[k]);
  }
}

// Digits of two fields to four numbers of four digits each, and what is no digit.
struct TwoFields {
  __m256i fours, strange;
};

LIBCHAR_VECTOR_INLINE inline TwoFields digits_of_two(const char* const* begin, const std::uint32_t* length,
                                                     std::uint32_t* distance) {
  const __m256i raw = both(begin[0], begin[1]);
  const auto points = static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(raw, _mm256_set1_epi8('.'))));
  const void* gather[2];
  for (std::size_t i = 0; i < 2; ++i) {
    const std::uint32_t safe = length[i] & 31U;
    const std::uint32_t point = _tzcnt_u32((points >> (16 * i)) | (std::uint32_t{1} << safe));
    distance[i] = safe - point;
    gather[i] = kGather.index[point][safe];
  }
  const __m256i packed = _mm256_shuffle_epi8(_mm256_sub_epi8(raw, _mm256_set1_epi8('0')), both(gather[0], gather[1]));
  const __m256i pairs = _mm256_maddubs_epi16(packed, _mm256_set1_epi16(0x010A));  // 10 a + b
  return {_mm256_madd_epi16(pairs, _mm256_set1_epi32(0x00010064)),                // 100 a + b
          _mm256_subs_epu8(packed, _mm256_set1_epi8(9))};
}

/// Four fields of a column at `stop` to four values: they share most instructions, and what is
/// wrong with one of them shows at the end; then there is nothing stored and the answer is false.
template <bool kLast>
LIBCHAR_VECTOR_INLINE inline bool four_fields(const Column& column, const std::uint32_t* stop, double* values,
                                              std::uint32_t& fractional) {
  FourFields at;
  locate_fours<kLast>(column, stop, at);
  std::uint32_t distance[4];
  const TwoFields low_two = digits_of_two(at.begin, at.length, distance);
  const TwoFields high_two = digits_of_two(at.begin + 2, at.length + 2, distance + 2);
  const __m256i anything = _mm256_or_si256(low_two.strange, high_two.strange);
  // 32-bit numbers below 10^8: high and low of fields 0 and 2, then of 1 and 3; put in order.
  const __m256i eights =
      _mm256_madd_epi16(_mm256_packus_epi32(low_two.fours, high_two.fours), _mm256_set1_epi32(0x00012710));
  const __m256i ordered = _mm256_permutevar8x32_epi32(eights, _mm256_setr_epi32(0, 4, 2, 6, 1, 5, 3, 7));
  const __m256d high = _mm256_cvtepi32_pd(_mm256_castsi256_si128(ordered)),
                low = _mm256_cvtepi32_pd(_mm256_extracti128_si256(ordered, 1));
  // Exact: 10^8 is 2^8 times a number of 19 bits, and the sum stays below 2^53.
  const __m256d whole = _mm256_add_pd(_mm256_mul_pd(high, _mm256_set1_pd(1e8)), low);
  const auto divisor = [&](std::size_t k) __attribute__((always_inline)) {
    return kDivisors[distance[k] + 32 * at.sign[k]];
  };
  const __m256d divisors = _mm256_setr_pd(divisor(0), divisor(1), divisor(2), divisor(3));
  const __m256d good = _mm256_and_pd(_mm256_cmp_pd(whole, _mm256_set1_pd(0x1p53), _CMP_LT_OQ),
                                     _mm256_cmp_pd(divisors, divisors, _CMP_ORD_Q));
  if (__builtin_expect(at.foreign != 0 || at.room < 0 || _mm256_testz_si256(anything, anything) == 0 ||
                           _mm256_movemask_pd(good) != 15,
                       0))
    return false;
  _mm256_storeu_pd(values, _mm256_div_pd(whole, divisors));
  fractional |= distance[0] | distance[1] | distance[2] | distance[3];
  return true;
}

/// Whole fours of rows, as long as all fields are regular. Row 0 must not be among the rows.
/// Returns the first row that is left.
template <bool kLast>
LIBCHAR_VECTOR_INLINE inline std::size_t take_fours(const Column& column, std::size_t row, std::size_t last,
                                                    double* values, std::uint32_t& fractional) {
  const std::uint32_t* stop = column.stops + row * column.width + column.index;
  for (; row + 4 <= last; row += 4, stop += 4 * column.width)
    if (!four_fields<kLast>(column, stop, values + row, fractional)) break;
  return row;
}

}  // namespace libchar::vector_parsing

#endif

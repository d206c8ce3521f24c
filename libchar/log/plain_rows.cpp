// Two stages, after the idea of Langdale & Lemire, "Parsing gigabytes of JSON per second" (VLDB J. 28, 2019): first the positions of
// all separators as bit masks of 64 bytes, then each field on its own, so that no field waits for the end of the one before it.
//
// A field -?D*.D* of at most 16 characters behind the sign becomes an integer m of its digits and f, the number of digits
// behind the point; m < 2^53 and 10^f <= 10^15 are exact doubles, so m / 10^f is rounded once (Clinger 1990, fast path).

#include "libchar/log/plain_rows.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace libchar {

#if defined(__x86_64__)
namespace {

constexpr std::array<double, 17> kPowers = {1,   1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7, 1e8,
                                            1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16};
constexpr std::array<std::int64_t, 10> kIntegerPowers = {1, 10, 100, 1000, 10000, 100000, 1000000, 10000000, 100000000, 1000000000};
constexpr std::int64_t kExactInteger = std::int64_t{1} << 53U;

// gather[point][length] moves the digits of a field, without its point, to the right end of 16 bytes; 0x80 gives zero. Without a
// point: point = length. Of nothing it takes the separator behind, which is no digit. Lengths up to 31 may be asked for; beyond 16
// the answer means nothing.
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

constexpr Gather kGather = make_gather();

/// Offsets of the delimiters and line feeds of `text` into `positions` (grown as needed), until there are `enough`; returns their number.
__attribute__((target("avx2,bmi,bmi2,popcnt"))) std::size_t find_separators(std::string_view text, char delimiter, std::size_t enough, std::vector<std::uint32_t>& positions) {
  const __m256i wanted = _mm256_set1_epi8(delimiter), feed = _mm256_set1_epi8('\n');
  std::size_t count = 0;
  for (std::size_t at = 0; at < text.size() && count < enough; at += 64) {
    if (positions.size() < count + 64 + 8) positions.resize(2 * positions.size() + 4096);
    std::uint64_t mask = 0;
    for (unsigned half = 0; half < 2; ++half) {
      const __m256i bytes = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(text.data() + at + 32 * half));
      const __m256i hit = _mm256_or_si256(_mm256_cmpeq_epi8(bytes, wanted), _mm256_cmpeq_epi8(bytes, feed));
      mask |= static_cast<std::uint64_t>(static_cast<std::uint32_t>(_mm256_movemask_epi8(hit))) << (32 * half);
    }
    if (at + 64 > text.size()) mask &= (std::uint64_t{1} << (text.size() - at)) - 1;
    const auto found = static_cast<std::size_t>(_mm_popcnt_u64(mask));
    std::uint32_t* out = positions.data() + count;
    // Eight at a time without asking: positions beyond `found` are overwritten by the next 64 bytes.
    for (std::size_t done = 0; done < found || done == 0; done += 8)
      for (std::size_t k = 0; k < 8; ++k) {
        out[done + k] = static_cast<std::uint32_t>(at + _tzcnt_u64(mask));
        mask = _blsr_u64(mask);
      }
    count += found;
  }
  return count;
}

// Constants of the vector code, as memory operands.
struct alignas(16) Bytes {
  std::uint8_t value[16];
};
consteval Bytes all(std::uint8_t byte) {
  Bytes bytes{};
  for (auto& b : bytes.value) b = byte;
  return bytes;
}
constexpr Bytes kPoint = all('.'), kZero = all('0'), kNine = all(9);
__m128i vector_of(const Bytes& bytes) { return _mm_load_si128(reinterpret_cast<const __m128i*>(bytes.value)); }

struct Field {
  std::int64_t digits = 0;   // all digits as one integer
  std::uint32_t behind = 0;  // how many of them stand behind the point
  bool plain = false;
};

__attribute__((target("avx2,bmi,bmi2,popcnt"), always_inline)) inline Field read_field(const char* text, std::uint32_t length) {
  const __m128i raw = _mm_loadu_si128(reinterpret_cast<const __m128i*>(text));
  const std::uint32_t inside = _bzhi_u32(0xFFFF, length);
  const std::uint32_t points = static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_cmpeq_epi8(raw, vector_of(kPoint)))) & inside;
  const __m128i digit = _mm_sub_epi8(raw, vector_of(kZero));
  const auto is_digit = static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_cmpeq_epi8(_mm_min_epu8(digit, vector_of(kNine)), digit)));
  Field field;
  // Branches that are never taken in a plain file are cheaper than one flag put together from four.
  if (__builtin_expect(length > 16 || ((is_digit | points) & inside) != inside || (points & (points - 1)) != 0 || (is_digit & inside) == 0 || (points != 0 && (points << 1U) > inside), 0)) return field;
  field.plain = true;
  const std::uint32_t point = _tzcnt_u32(points | (std::uint32_t{1} << length));
  field.behind = length - point - static_cast<std::uint32_t>(points != 0);
  const __m128i packed = _mm_shuffle_epi8(digit, _mm_load_si128(reinterpret_cast<const __m128i*>(kGather.index[point][length])));
  const __m128i pairs = _mm_maddubs_epi16(packed, _mm_setr_epi8(10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1));
  const __m128i fours = _mm_madd_epi16(pairs, _mm_setr_epi16(100, 1, 100, 1, 100, 1, 100, 1));
  const __m128i words = _mm_packus_epi32(fours, fours);
  const __m128i eights = _mm_madd_epi16(words, _mm_setr_epi16(10000, 1, 10000, 1, 10000, 1, 10000, 1));
  const auto both = static_cast<std::uint64_t>(_mm_cvtsi128_si64(eights));
  field.digits = static_cast<std::int64_t>((both & 0xFFFFFFFFU) * 100000000U + (both >> 32U));
  return field;
}

// What the slow parsers give back by value: an address of a local would keep the fast path's variables in memory.
template <class T>
struct Slow {
  T value{};
  bool good = false;
  bool integer = false;  // written with digits only
};

// Exponents, 17 digits and more: the library's parser, with the rule "ended at the end of the field, and finite". Very long fields
// and numbers beyond 2^53 (integers there may not be exact) are for the general parser to judge.
__attribute__((noinline)) Slow<double> read_value_slowly(const char* begin, const char* end) {
  Slow<double> out;
  if (begin == end || end - begin > 64) return out;
  const auto [stop, status] = std::from_chars(begin, end, out.value);
  out.good = status == std::errc() && stop == end && std::fabs(out.value) < 0x1p53;
  out.integer = std::all_of(begin + (*begin == '-'), end, [](char c) { return c >= '0' && c <= '9'; });
  return out;
}

__attribute__((noinline)) Slow<std::int64_t> read_stamp_slowly(const char* begin, const char* end, int stamp_digits) {
  Slow<std::int64_t> out;
  if (stamp_digits != 0) return out;
  const auto [stop, status] = std::from_chars(begin, end, out.value);
  out.good = status == std::errc() && stop == end;
  return out;
}

/// The fields of one column over consecutive rows: field r lies between the separators at stops[r * width - 1] (the byte before
/// the text for the very first) and stops[r * width].
struct Column {
  const char* text;
  const std::uint32_t* stops;  // of all columns
  std::size_t width, index;
  char delimiter;
  bool crlf;
};

/// Reads rows [first, last) of a column with `take(row, begin, end, negative, field)`; returns the first row that it refuses.
template <bool kLast, class Take>
__attribute__((target("avx2,bmi,bmi2,popcnt"), always_inline)) inline std::size_t take_fields(const Column column, std::size_t first, const std::size_t last, Take take) {
  const char* const text = column.text;
  const std::size_t width = column.width;
  const char separator = kLast ? '\n' : column.delimiter;
  const std::uint32_t* stop = column.stops + first * width + column.index;
  for (std::size_t row = first; row < last; ++row, stop += width) {
    const std::size_t from = stop == column.stops ? 0 : stop[-1] + std::size_t{1};
    std::size_t to = *stop;
    if (__builtin_expect(text[to] != separator, 0)) return row;
    if (kLast && column.crlf) {
      if (__builtin_expect(to == from || text[to - 1] != '\r', 0)) return row;
      --to;
    }
    const char* const begin = text + from;
    // Arithmetic instead of a branch: the sign of noise is a coin toss that no predictor guesses.
    const std::uint32_t negative = ((static_cast<std::uint32_t>(static_cast<unsigned char>(*begin)) ^ std::uint32_t{'-'}) - 1U) >> 31U;
    if (__builtin_expect(!take(row, begin, text + to, negative, read_field(begin + negative, static_cast<std::uint32_t>(to - from) - negative)), 0)) return row;
  }
  return last;
}

template <class Take>
__attribute__((target("avx2,bmi,bmi2,popcnt"), always_inline)) inline std::size_t take_column(const Column& column, std::size_t first, std::size_t last, Take take) {
  return column.index + 1 == column.width ? take_fields<true>(column, first, last, take) : take_fields<false>(column, first, last, take);
}

// What to divide by, by the distance from the point (or the end, when there is none) to the end: 10^(distance - 1); nothing good when
// the point stands last. From 32 on with a sign, which the quotient takes over.
constexpr auto kDivisors = [] {
  std::array<double, 64> table{};
  for (std::size_t distance = 0; distance < 32; ++distance) {
    const bool plain = distance == 0 || (distance >= 2 && distance <= 17);
    table[distance] = !plain ? __builtin_nan("") : distance == 0 ? 1 : kPowers[distance - 1];
    table[32 + distance] = -table[distance];
  }
  return table;
}();

__attribute__((target("avx2,bmi,bmi2,popcnt"), always_inline)) inline __m256i both(const void* low, const void* high) {
  const __m128i first = _mm_loadu_si128(static_cast<const __m128i*>(low)), second = _mm_loadu_si128(static_cast<const __m128i*>(high));
  return _mm256_inserti128_si256(_mm256_castsi128_si256(first), second, 1);
}

/// The same as `take_values` below for whole fours of rows, as long as all four are plain: four fields share most instructions, and
/// what is wrong with one of them shows at the end. Row 0 must not be among them. Returns the first row that is left.
template <bool kLast>
__attribute__((target("avx2,bmi,bmi2,popcnt"), always_inline)) inline std::size_t take_fours(const Column column, std::size_t row, const std::size_t last, double* const values, std::uint32_t& fractional) {
  const char* const text = column.text;
  const std::size_t width = column.width;
  const std::uint32_t separator = static_cast<unsigned char>(kLast ? '\n' : column.delimiter);
  const std::uint32_t* stop = column.stops + row * width + column.index;
  const __m256i point_byte = _mm256_set1_epi8('.'), zero_byte = _mm256_set1_epi8('0'), nine = _mm256_set1_epi8(9);
  for (; row + 4 <= last; row += 4, stop += 4 * width) {
    const char* begin[4];
    std::uint32_t length[4], sign[4], foreign = 0;
    std::int32_t room = 0;  // negative when a field has more than 16 characters
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t from = stop[k * width - 1] + 1;
      std::uint32_t to = stop[k * width];
      foreign |= static_cast<unsigned char>(text[to]) ^ separator;
      if (kLast && column.crlf) foreign |= static_cast<unsigned char>(text[--to]) ^ std::uint32_t{'\r'};
      sign[k] = ((static_cast<std::uint32_t>(static_cast<unsigned char>(text[from])) ^ std::uint32_t{'-'}) - 1U) >> 31U;
      begin[k] = text + from + sign[k];
      length[k] = to - from - sign[k];
      room |= 16 - static_cast<std::int32_t>(length[k]);
    }
    std::uint32_t distance[4];
    __m256i fours[2], strange[2];
    for (std::size_t h = 0; h < 2; ++h) {
      const __m256i raw = both(begin[2 * h], begin[2 * h + 1]);
      const auto points = static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(raw, point_byte)));
      const void* gather[2];
      for (std::size_t i = 0; i < 2; ++i) {
        const std::uint32_t safe = length[2 * h + i] & 31U;
        const std::uint32_t point = _tzcnt_u32((points >> (16 * i)) | (std::uint32_t{1} << safe));
        distance[2 * h + i] = safe - point;
        gather[i] = kGather.index[point][safe];
      }
      const __m256i packed = _mm256_shuffle_epi8(_mm256_sub_epi8(raw, zero_byte), both(gather[0], gather[1]));
      strange[h] = _mm256_subs_epu8(packed, nine);
      const __m256i pairs = _mm256_maddubs_epi16(packed, _mm256_set1_epi16(0x010A));     // 10 a + b
      fours[h] = _mm256_madd_epi16(pairs, _mm256_set1_epi32(0x00010064));                // 100 a + b
    }
    const __m256i anything = _mm256_or_si256(strange[0], strange[1]);
    // 32-bit numbers below 10^8: high and low of fields 0 and 2, then of 1 and 3; put in order.
    const __m256i eights = _mm256_madd_epi16(_mm256_packus_epi32(fours[0], fours[1]), _mm256_set1_epi32(0x00012710));
    const __m256i ordered = _mm256_permutevar8x32_epi32(eights, _mm256_setr_epi32(0, 4, 2, 6, 1, 5, 3, 7));
    const __m256d high = _mm256_cvtepi32_pd(_mm256_castsi256_si128(ordered)), low = _mm256_cvtepi32_pd(_mm256_extracti128_si256(ordered, 1));
    // Exact: 10^8 is 2^8 times a number of 19 bits, and the sum stays below 2^53.
    const __m256d whole = _mm256_add_pd(_mm256_mul_pd(high, _mm256_set1_pd(1e8)), low);
    const auto divisor = [&](std::size_t k) __attribute__((always_inline)) { return kDivisors[distance[k] + 32 * sign[k]]; };
    const __m256d divisors = _mm256_setr_pd(divisor(0), divisor(1), divisor(2), divisor(3));
    const __m256d good = _mm256_and_pd(_mm256_cmp_pd(whole, _mm256_set1_pd(0x1p53), _CMP_LT_OQ), _mm256_cmp_pd(divisors, divisors, _CMP_ORD_Q));
    if (__builtin_expect(foreign != 0 || room < 0 || _mm256_testz_si256(anything, anything) == 0 || _mm256_movemask_pd(good) != 15, 0)) return row;
    _mm256_storeu_pd(values + row, _mm256_div_pd(whole, divisors));
    fractional |= distance[0] | distance[1] | distance[2] | distance[3];
  }
  return row;
}

__attribute__((target("avx2,bmi,bmi2,popcnt"))) std::size_t take_values(const Column& column, std::size_t first, std::size_t last, const PlainColumn& to) {
  double* const values = to.values;
  std::uint32_t behind = 0;  // of all fields together
  const auto one = [&](std::size_t row, const char* begin, const char* end, std::uint32_t negative, const Field& field) __attribute__((target("avx2,bmi,bmi2,popcnt"), always_inline)) {
    if (__builtin_expect(!field.plain || field.digits >= kExactInteger, 0)) {
      const Slow<double> slow = read_value_slowly(begin, end);
      values[row] = slow.value;
      behind |= static_cast<std::uint32_t>(slow.good && !slow.integer);  // a refused field says nothing about the column
      return slow.good;
    }
    behind |= field.behind;
    const double magnitude = static_cast<double>(field.digits) / kPowers[field.behind];
    values[row] = std::bit_cast<double>(std::bit_cast<std::uint64_t>(magnitude) | (std::uint64_t{negative} << 63U));
    return true;
  };
  std::size_t row = first, alone = 1;  // the very first row goes alone
  while (row < last) {
    if (row > 0) {
      const std::size_t before = row;
      row = column.index + 1 == column.width ? take_fours<true>(column, row, last, values, behind) : take_fours<false>(column, row, last, values, behind);
      alone = row > before ? 4 : 64;  // a column of seventeen digits is not asked every time
    }
    const std::size_t end = std::min(last, row + alone);
    row = take_column(column, row, end, one);
    if (row != end) break;
  }
  if (to.fractional != nullptr) *to.fractional = static_cast<char>(*to.fractional | (behind != 0));
  return row;
}

__attribute__((target("avx2,bmi,bmi2,popcnt"))) std::size_t take_stamps(const Column& column, std::size_t first, std::size_t last, const PlainColumn& to) {
  return take_column(column, first, last, [&](std::size_t row, const char* begin, const char* end, std::uint32_t negative, const Field& field) __attribute__((target("avx2,bmi,bmi2,popcnt"), always_inline)) {
    const int shift = to.stamp_digits - static_cast<int>(field.behind);
    if (__builtin_expect(field.plain && shift >= 0, 1))
      return !__builtin_mul_overflow(negative ? -field.digits : field.digits, kIntegerPowers[static_cast<std::size_t>(shift)], &to.stamps[row]);
    const Slow<std::int64_t> slow = read_stamp_slowly(begin, end, to.stamp_digits);
    to.stamps[row] = slow.value;
    return slow.good;
  });
}

__attribute__((target("avx2,bmi,bmi2,popcnt"))) std::size_t check_fields(const Column& column, std::size_t first, std::size_t last) {
  return take_column(column, first, last, [](std::size_t, const char* begin, const char* end, std::uint32_t, const Field& field) __attribute__((target("avx2,bmi,bmi2,popcnt"), always_inline)) {
    return field.plain || read_value_slowly(begin, end).good;
  });
}

constexpr std::size_t kBatch = 128;  // rows read column by column while their text is in the first-level cache

PlainRows parse(std::string_view text, char delimiter, bool crlf, std::span<const PlainColumn> columns, std::size_t max_rows, std::vector<std::uint32_t>& scratch) {
  const std::size_t width = columns.size();
  const std::size_t rows = std::min(max_rows, find_separators(text, delimiter, max_rows * width, scratch) / width);
  std::size_t good = 0;
  for (std::size_t first = 0; first < rows; first = good) {
    good = std::min(rows, first + kBatch);
    const std::size_t whole = good;
    for (std::size_t c = 0; c < width; ++c) {
      const Column column{text.data(), scratch.data(), width, c, delimiter, crlf};
      switch (columns[c].use) {
        case PlainColumn::Use::value: good = take_values(column, first, good, columns[c]); break;
        case PlainColumn::Use::stamp: good = take_stamps(column, first, good, columns[c]); break;
        case PlainColumn::Use::skip: good = check_fields(column, first, good); break;
      }
    }
    if (good != whole) break;
  }
  return {good, good == 0 ? 0 : scratch[good * width - 1] + std::size_t{1}};
}

}  // namespace

PlainRows parse_plain_rows(std::string_view text, char delimiter, bool crlf, std::span<const PlainColumn> columns, std::size_t max_rows, std::vector<std::uint32_t>& scratch) {
  static const bool capable = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt");
  if (!capable || columns.empty()) return {};
  return parse(text, delimiter, crlf, columns, max_rows, scratch);
}

#else

PlainRows parse_plain_rows(std::string_view, char, bool, std::span<const PlainColumn>, std::size_t, std::vector<std::uint32_t>&) { return {}; }

#endif

}  // namespace libchar

// Two stages, after the idea of Langdale & Lemire, "Parsing gigabytes of JSON per second" (VLDB J.
// 28, 2019): first the positions of all separators as bit masks of 64 bytes, then each field on its
// own, so that no field waits for the end of the one before it.

#include "libchar/log/csv/rows/vector_rows.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>

#include "libchar/core/text/double_text.hpp"
#include "libchar/log/csv/rows/vector_fours.hpp"

namespace libchar {

#if defined(LIBCHAR_VECTOR)

using namespace vector_parsing;

namespace {

/// Which of 64 bytes are delimiters or line feeds.
#if defined(LIBCHAR_X86_64)
LIBCHAR_VECTOR_INLINE inline std::uint64_t separators_of(const char* bytes, char delimiter) {
  const __m256i wanted = _mm256_set1_epi8(delimiter), line_feed = _mm256_set1_epi8('\n');
  std::uint64_t mask = 0;
  for (unsigned half = 0; half < 2; ++half) {
    const __m256i text = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(bytes + 32 * half));
    const __m256i hit = _mm256_or_si256(_mm256_cmpeq_epi8(text, wanted), _mm256_cmpeq_epi8(text, line_feed));
    mask |= static_cast<std::uint64_t>(static_cast<std::uint32_t>(_mm256_movemask_epi8(hit))) << (32 * half);
  }
  return mask;
}
#else
LIBCHAR_VECTOR_INLINE inline std::uint64_t separators_of(const char* bytes, char delimiter) {
  const v128_t wanted = wasm_i8x16_splat(delimiter), line_feed = wasm_i8x16_const_splat('\n');
  std::uint64_t mask = 0;
  for (unsigned quarter = 0; quarter < 4; ++quarter) {
    const v128_t text = wasm_v128_load(bytes + 16 * quarter);
    const v128_t hit = wasm_v128_or(wasm_i8x16_eq(text, wanted), wasm_i8x16_eq(text, line_feed));
    mask |= static_cast<std::uint64_t>(wasm_i8x16_bitmask(hit)) << (16 * quarter);
  }
  return mask;
}
#endif

/// Offsets of the delimiters and line feeds of `text` into `positions` (grown as needed), until
/// there are `enough`; returns their number.
LIBCHAR_VECTOR std::size_t find_separators(std::string_view text, char delimiter, std::size_t enough,
                                           std::vector<std::uint32_t>& positions) {
  std::size_t count = 0;
  for (std::size_t at = 0; at < text.size() && count < enough; at += 64) {
    if (positions.size() < count + 64 + 8) positions.resize(2 * positions.size() + 4096);
    std::uint64_t mask = separators_of(text.data() + at, delimiter);
    if (at + 64 > text.size()) mask &= (std::uint64_t{1} << (text.size() - at)) - 1;
    const auto found = static_cast<std::size_t>(std::popcount(mask));
    std::uint32_t* out = positions.data() + count;
    // Eight at a time without asking: positions beyond `found` are overwritten by the next 64 bytes.
    for (std::size_t done = 0; done < found || done == 0; done += 8)
      for (std::size_t k = 0; k < 8; ++k) {
        out[done + k] = static_cast<std::uint32_t>(at) + static_cast<std::uint32_t>(std::countr_zero(mask));
        mask &= mask - 1;
      }
    count += found;
  }
  return count;
}

// What the slow parsers give back by value: an address of a local would keep the fast path's variables in memory.
template <class T>
struct Slow {
  T value{};
  bool good = false;
  bool integer = false;  // written with digits only
};

// Exponents, 17 digits and more: the library's parser, with the rule "ended at the end of the field, and finite". Very
// long fields and numbers beyond 2^53 (integers there may not be exact) are for the general parser to judge.
__attribute__((noinline)) Slow<double> read_value_slowly(const char* begin, const char* end) {
  Slow<double> out;
  if (begin == end || end - begin > 64) return out;
  const auto [stop, status] = detail::read_double(begin, end, out.value);
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

/// Reads rows [first, last) of a column with `take(row, begin, end, negative, field)`; returns the
/// first row that it refuses.
template <bool kLast, class Take>
LIBCHAR_VECTOR_INLINE inline std::size_t take_fields(const Column column, std::size_t first, const std::size_t last,
                                                     Take take) {
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
    const std::uint32_t negative =
        ((static_cast<std::uint32_t>(static_cast<unsigned char>(*begin)) ^ std::uint32_t{'-'}) - 1U) >> 31U;
    if (__builtin_expect(!take(row, begin, text + to, negative,
                               read_field(begin + negative, static_cast<std::uint32_t>(to - from) - negative)),
                         0))
      return row;
  }
  return last;
}

template <class Take>
LIBCHAR_VECTOR_INLINE inline std::size_t take_column(const Column& column, std::size_t first, std::size_t last,
                                                     Take take) {
  return column.index + 1 == column.width ? take_fields<true>(column, first, last, take)
                                          : take_fields<false>(column, first, last, take);
}

LIBCHAR_VECTOR std::size_t take_values(const Column& column, std::size_t first, std::size_t last,
                                       const VectorColumn& to) {
  double* const values = to.values;
  std::uint32_t behind = 0;  // of all fields together
  const auto one = [&](std::size_t row, const char* begin, const char* end, std::uint32_t negative,
                       const Field& field) LIBCHAR_VECTOR_INLINE {
    if (__builtin_expect(!field.regular || field.digits >= kExactInteger, 0)) {
      const Slow<double> slow = read_value_slowly(begin, end);
      values[row] = slow.value;
      behind |=
          static_cast<std::uint32_t>(slow.good && !slow.integer);  // a refused field says nothing about the column
      return slow.good;
    }
    behind |= field.behind;
    const double magnitude = static_cast<double>(field.digits) / kPowers[field.behind];
    values[row] = std::bit_cast<double>(std::bit_cast<std::uint64_t>(magnitude) | (std::uint64_t{negative} << 63U));
    return true;
  };
  std::size_t row = first, alone = 1;  // the very first row goes alone
  while (row < last) {
#if defined(LIBCHAR_X86_64)
    if (row > 0) {
      const std::size_t before = row;
      row = column.index + 1 == column.width ? take_fours<true>(column, row, last, values, behind)
                                             : take_fours<false>(column, row, last, values, behind);
      alone = row > before ? 4 : 64;  // a column of seventeen digits is not asked every time
    }
#else
    alone = last - row;
#endif
    const std::size_t end = std::min(last, row + alone);
    row = take_column(column, row, end, one);
    if (row != end) break;
  }
  if (to.fractional != nullptr) *to.fractional = static_cast<char>(*to.fractional | (behind != 0));
  return row;
}

LIBCHAR_VECTOR std::size_t take_stamps(const Column& column, std::size_t first, std::size_t last,
                                       const VectorColumn& to) {
  return take_column(
      column, first, last,
      [&](std::size_t row, const char* begin, const char* end, std::uint32_t negative, const Field& field)
          LIBCHAR_VECTOR_INLINE {
            const int shift = to.stamp_digits - static_cast<int>(field.behind);
            if (__builtin_expect(field.regular && shift >= 0, 1))
              return !__builtin_mul_overflow(negative ? -field.digits : field.digits,
                                             kIntegerPowers[static_cast<std::size_t>(shift)], &to.stamps[row]);
            const Slow<std::int64_t> slow = read_stamp_slowly(begin, end, to.stamp_digits);
            to.stamps[row] = slow.value;
            return slow.good;
          });
}

LIBCHAR_VECTOR std::size_t check_fields(const Column& column, std::size_t first, std::size_t last) {
  return take_column(column, first, last,
                     [](std::size_t, const char* begin, const char* end, std::uint32_t, const Field& field)
                         LIBCHAR_VECTOR_INLINE { return field.regular || read_value_slowly(begin, end).good; });
}

constexpr std::size_t kBatch = 128;  // rows read column by column while their text is in the first-level cache

LIBCHAR_VECTOR VectorRows parse(std::string_view text, char delimiter, bool crlf, std::span<const VectorColumn> columns,
                                std::size_t max_rows, std::vector<std::uint32_t>& scratch) {
  const std::size_t width = columns.size();
  const std::size_t rows = std::min(max_rows, find_separators(text, delimiter, max_rows * width, scratch) / width);
  std::size_t good = 0;
  std::vector<char> fractional(width, 0);  // before the batch
  for (std::size_t first = 0; first < rows; first = good) {
    for (std::size_t c = 0; c < width; ++c)
      if (columns[c].fractional != nullptr) fractional[c] = *columns[c].fractional;
    good = std::min(rows, first + kBatch);
    const std::size_t whole = good;
    for (std::size_t c = 0; c < width; ++c) {
      const Column column{text.data(), scratch.data(), width, c, delimiter, crlf};
      switch (columns[c].use) {
        case VectorColumn::Use::value:
          good = take_values(column, first, good, columns[c]);
          break;
        case VectorColumn::Use::stamp:
          good = take_stamps(column, first, good, columns[c]);
          break;
        case VectorColumn::Use::skip:
          good = check_fields(column, first, good);
          break;
      }
    }
    if (good == whole) continue;
    // What was noted of rows behind the last good one does not count: their cells may stand elsewhere.
    for (std::size_t c = 0; c < width; ++c) {
      if (columns[c].use != VectorColumn::Use::value) continue;
      if (columns[c].fractional != nullptr) *columns[c].fractional = fractional[c];
      take_values(Column{text.data(), scratch.data(), width, c, delimiter, crlf}, first, good, columns[c]);
    }
    break;
  }
  return {good, good == 0 ? 0 : scratch[good * width - 1] + std::size_t{1}};
}

}  // namespace

VectorRows parse_vector_rows(std::string_view text, char delimiter, bool crlf, std::span<const VectorColumn> columns,
                             std::size_t max_rows, std::vector<std::uint32_t>& scratch) {
#if defined(LIBCHAR_X86_64)
  if (detail::instructions() < detail::Instructions::avx2) return {};
#endif
  if (columns.empty()) return {};
  return parse(text, delimiter, crlf, columns, max_rows, scratch);
}

#else

VectorRows parse_vector_rows(std::string_view, char, bool, std::span<const VectorColumn>, std::size_t,
                             std::vector<std::uint32_t>&) {
  return {};
}

#endif

}  // namespace libchar

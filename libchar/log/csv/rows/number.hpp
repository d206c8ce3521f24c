#pragma once
// Decimal text to the nearest double, and decimal time stamps to whole nanoseconds: the scalar tier
// of number parsing, one number at a time. The other tier takes whole columns by AVX2
// (vector_rows.hpp) and leaves to this one what it does not know.
//
// The reference is read_cell, by std::from_chars. In rows of nothing but numbers quick_number
// stands before it and returns nullptr for what it leaves to read_cell: with std::from_chars in its
// place, files with decimal commas or with missing cells are read at half the speed
// (docs/theory/speed.md). Both round to nearest, ties to even, so the bits are the same
// (csv_number_test).

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "libchar/log/csv/rows/decimal.hpp"

namespace libchar::csv {

inline constexpr std::array<std::int64_t, 10> kNanoseconds = {
    1, 10, 100, 1000, 10000, 100000, 1000000, 10000000, 100000000, 1000000000};

inline bool is_digit(char c) {
  return static_cast<unsigned char>(c - '0') < 10;
}

inline std::uint64_t load8(const char* p) {
  std::uint64_t v = 0;
  std::memcpy(&v, p, sizeof v);
  return v;
}

/// Eight digit values (0…9, first digit in the lowest byte) to their number: pairs, fours, eight.
inline std::uint64_t value_of_eight(std::uint64_t digits) {
  digits = digits * 10 + (digits >> 8U);
  return (((digits & 0x000000FF000000FFU) * 0x000F424000000064U) +
          (((digits >> 16U) & 0x000000FF000000FFU) * 0x0000271000000001U)) >>
         32U;
}

inline constexpr std::array<std::uint64_t, 8> kShift = {
    1, 10, 100, 1000, 10000, 100000, 1000000, 10000000};

/// Appends the digits at p to w and returns the end of them. The text must be readable 8 bytes past
/// its end. Eight bytes are looked at together; how many of them are digits decides a shift, not a
/// branch.
inline const char* read_digits(const char* p, std::uint64_t& w) {
  for (;;) {
    const std::uint64_t digits = load8(p) ^ 0x3030303030303030U;
    // The top bit of every byte that is not 0…9.
    const std::uint64_t others = ((digits + 0x7676767676767676U) | digits) & 0x8080808080808080U;
    if (others == 0) {
      w = w * 100000000 + value_of_eight(digits);
      p += 8;
      continue;
    }
    const unsigned n = static_cast<unsigned>(std::countr_zero(others)) / 8;
    w = w * kShift[n] + value_of_eight((digits << (56 - 8 * n)) << 8U);
    return p + n;
  }
}

/// The number at p, with `point` as decimal mark. Returns its end and sets `value`, or returns
/// nullptr when read_cell has to look at it: signs '+', words, more than 19 digits, extreme exponents, no
/// number at all.
inline const char* quick_number(const char* p, char point, double& value, bool& integer) {
  const bool negative = *p == '-';
  p += negative;
  const char* const first = p;
  std::uint64_t w = 0;
  p = read_digits(p, w);
  std::ptrdiff_t digits = p - first;
  int q = 0;
  integer = true;
  if (*p == point) {
    integer = false;
    const char* const fraction = ++p;
    p = read_digits(p, w);
    q = -static_cast<int>(p - fraction);
    digits += p - fraction;
  }
  if (*first == '0' && !integer) {
    // Leading zeros are no significant digits: up to eight of them behind the mark are taken off in
    // one go.
    const std::uint64_t zeros = load8(first + 2) ^ 0x3030303030303030U;
    if (first[1] == point) digits -= 1 + (zeros == 0 ? 8 : std::countr_zero(zeros) / 8);
    digits = digits < 1 ? 1 : digits;
  }
  if (digits == 0 || digits > 19) return nullptr;
  if ((*p | 0x20) == 'e') {
    integer = false;
    const char* e = p + 1;
    const bool down = *e == '-';
    e += *e == '-' || *e == '+';
    int exponent = 0;
    const char* const start = e;
    while (is_digit(*e) && e - start < 4) exponent = exponent * 10 + (*e++ - '0');
    if (e == start || is_digit(*e)) return nullptr;
    q += down ? -exponent : exponent;
    p = e;
  }
  double magnitude = 0;
  if (!nearest_double(w, digits, q, magnitude)) return nullptr;
  value = std::bit_cast<double>(std::bit_cast<std::uint64_t>(magnitude) |
                                (static_cast<std::uint64_t>(negative) << 63U));
  return p;
}

/// The same for a time stamp in a unit of 10^unit_digits ns: whole nanoseconds, or nullptr for
/// read_stamp.
inline const char* quick_stamp(const char* p, char point, int unit_digits, std::int64_t& stamp) {
  const bool negative = *p == '-';
  p += negative;
  const char* const first = p;
  std::uint64_t w = 0;
  p = read_digits(p, w);
  std::ptrdiff_t digits = p - first;
  int scale = unit_digits;
  if (digits == 0) return nullptr;
  if (*p == point) {
    const char* const fraction = ++p;
    p = read_digits(p, w);
    digits += p - fraction;
    scale -= static_cast<int>(p - fraction);
  }
  std::int64_t ns = 0;
  if (digits > 19 || w > INT64_MAX || scale < 0 || scale > 9 ||
      __builtin_mul_overflow(
          static_cast<std::int64_t>(w), kNanoseconds[static_cast<std::size_t>(scale)], &ns))
    return nullptr;
  stamp = negative ? -ns : ns;
  return p;
}

/// What one cell of a value column says.
struct Cell {
  enum Kind { value, missing, infinite, bad, out_of_range } kind = bad;
  double number = 0;
  bool integer = false;
  bool too_small = false;        ///< 0 because its exponent is below those of doubles
  bool inexact_integer = false;  ///< an integer beyond 2^53 that a double cannot hold
  std::size_t offset = 0;        ///< bad: the byte that cannot be, from the start of the cell
  const char* reason = "";       ///< bad: in words
};

/// Reads a trimmed cell with all the rules of docs/formats.md: the whole cell is one finite number, a
/// word for "missing", an infinity (kept out like a missing sample), or wrong.
Cell read_cell(std::string_view text, char point);

/// A time stamp: decimal text times `unit_ns` nanoseconds, exact, the half nanosecond rounded to
/// even. `zero`, in the same unit, is taken off first.
enum class StampDefect { none, missing, malformed, out_of_range };
StampDefect read_stamp(std::string_view text,
                       char point,
                       std::int64_t unit_ns,
                       std::int64_t& out,
                       std::size_t& offset,
                       double zero = 0);

}  // namespace libchar::csv

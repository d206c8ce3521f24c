#pragma once
// Decimal text to the nearest double, and decimal time stamps to whole nanoseconds: the scalar tier
// of number parsing, one number at a time. The other tier takes whole columns by AVX2
// (vector_rows.hpp) and leaves to this one what it does not know.
//
// The reference is read_cell, by std::from_chars. In rows of nothing but numbers quick_number stands before it and
// returns nullptr for what it leaves to read_cell: with std::from_chars in its place, files with decimal commas or with
// missing cells are read at half the speed (docs/dev/speed.md). Both round to nearest, ties to even, so the bits are
// the same (csv_number_test).

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace libchar::csv {

// The nearest double to a decimal number w · 10^q with few digits, without std::from_chars: the
// arithmetic of the scalar tier (number.hpp).

__extension__ typedef unsigned __int128 Uint128;
__extension__ typedef __int128 Int128;

struct Wide {
  std::uint64_t high = 0, low = 0;
};

inline constexpr int kReciprocals = 28;

/// floor(2^s / 5^n) with s chosen so that the top bit of 128 is set; `shift` is s - 127.
struct Reciprocal {
  Wide bits;
  int shift = 0;
};

constexpr Reciprocal reciprocal_of_power_of_five(int n) {
  std::uint64_t divisor = 1;
  for (int i = 0; i < n; ++i) divisor *= 5;  // 5^27 < 2^63
  const int width = 64 - std::countl_zero(divisor);
  // 2^(127 + width) / divisor lies in [2^127, 2^128] because 2^(width-1) <= divisor < 2^width; n = 0 is not used.
  Uint128 remainder = 0;
  Reciprocal r;
  r.shift = width - (n == 0 ? 1 : 0);
  Uint128 quotient = 0;
  for (int bit = 127 + r.shift; bit >= 0; --bit) {  // schoolbook division of a single set bit, one bit at a time
    remainder = (remainder << 1U) | (bit == 127 + r.shift ? 1U : 0U);
    quotient <<= 1U;
    if (remainder >= divisor) {
      remainder -= divisor;
      quotient |= 1U;
    }
  }
  r.bits = {static_cast<std::uint64_t>(quotient >> 64U), static_cast<std::uint64_t>(quotient)};
  return r;
}

inline constexpr auto kReciprocal = [] {
  std::array<Reciprocal, kReciprocals> table{};
  for (int n = 0; n < kReciprocals; ++n) table[static_cast<std::size_t>(n)] = reciprocal_of_power_of_five(n);
  return table;
}();

inline constexpr std::array<double, 23> kPowerOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                       1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                       1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/// The nearest double to w / 10^n for 1 <= n <= 27; false when 128 bits do not decide the rounding.
inline bool divide_by_power_of_ten(std::uint64_t w, int n, double& out) {
  const Reciprocal& r = kReciprocal[static_cast<std::size_t>(n)];
  const int zeros = std::countl_zero(w);
  w <<= zeros;
  const Uint128 upper = static_cast<Uint128>(w) * r.bits.high;
  const Uint128 lower = static_cast<Uint128>(w) * r.bits.low;
  const Uint128 product = upper + static_cast<std::uint64_t>(lower >> 64U);  // top 128 of 192 bits, at most 2 too small
  const std::uint64_t high = static_cast<std::uint64_t>(product >> 64U);
  const std::uint64_t low = static_cast<std::uint64_t>(product);
  const int top = static_cast<int>(high >> 63U);
  const int dropped = 10 + top;  // bits of `high` below the 53 that are kept
  const std::uint64_t rest = high & ((std::uint64_t{1} << dropped) - 1);
  const std::uint64_t half = std::uint64_t{1} << (dropped - 1);
  // Unsure when the true value may lie on the other side of (or exactly on) a boundary.
  if (low >= ~std::uint64_t{3} && (rest == half - 1 || rest == 2 * half - 1)) return false;
  if (low <= 3 && (rest == half || rest == 0)) return false;
  std::uint64_t mantissa = (high >> dropped) + (rest >= half ? 1U : 0U);
  // w·2^-zeros · (bits · 2^-(127+shift)) · 2^-n; product = w·bits / 2^64.
  int exponent = 64 - 127 - r.shift - n - zeros + 64 + dropped;
  if (mantissa == std::uint64_t{1} << 53U) {
    mantissa >>= 1U;
    ++exponent;
  }
  // All numbers here lie between 1e-27 and 2^64: never subnormal, never infinite.
  out = std::bit_cast<double>((mantissa & ((std::uint64_t{1} << 52U) - 1)) |
                              (static_cast<std::uint64_t>(exponent + 1075) << 52U));
  return true;
}

/// The nearest double to w · 10^q, w made of `digits` digits; false where it takes more than one
/// rounding and 128 bits, which is for std::from_chars to do. The first way that is exact wins:
///   w < 2^53 and |q| <= 22      one rounding of w · 10^q or w / 10^-q            (Clinger 1990)
// /   w < 2^64 and -27 <= q < 0   128-bit reciprocal of 5^-q, unless the product lies too near a
// rounding boundary to be sure
///                               (Lemire, "Number parsing at a gigabyte per second", 2021)
inline bool nearest_double(std::uint64_t w, std::ptrdiff_t digits, int q, double& out) {
  const auto one_rounding = [&] {
    return q < 0 ? static_cast<double>(w) / kPowerOfTen[static_cast<std::size_t>(-q)]
                 : static_cast<double>(w) * kPowerOfTen[static_cast<std::size_t>(q)];
  };
  if (q == 0) {
    out = static_cast<double>(w);
  } else if (digits <= 15 && q >= -22 && q <= 22) {
    out = one_rounding();
  } else if (w == 0) {
    out = 0;
  } else if (q >= 0 || q < -27 || !divide_by_power_of_ten(w, -q, out)) {
    if (w >= (std::uint64_t{1} << 53U) || q < -22 || q > 22) return false;
    out = one_rounding();
  }
  return true;
}

inline constexpr std::array<std::int64_t, 10> kNanoseconds = {1,      10,      100,      1000,      10000,
                                                              100000, 1000000, 10000000, 100000000, 1000000000};

inline bool is_digit(char c) { return static_cast<unsigned char>(c - '0') < 10; }

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

inline constexpr std::array<std::uint64_t, 8> kShift = {1, 10, 100, 1000, 10000, 100000, 1000000, 10000000};

/// Appends the digits at p to w and returns the end of them. The text must be readable 8 bytes past its end. Eight
/// bytes are looked at together; how many of them are digits decides a shift, not a branch.
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

/// The number at p, with `point` as decimal mark. Returns its end and sets `value`, or returns nullptr when read_cell
/// has to look at it: signs '+', words, more than 19 digits, extreme exponents, no number at all.
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
    // Leading zeros are no significant digits: up to eight of them behind the mark are taken off in one go.
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
  value =
      std::bit_cast<double>(std::bit_cast<std::uint64_t>(magnitude) | (static_cast<std::uint64_t>(negative) << 63U));
  return p;
}

/// The same for a time stamp in a unit of 10^unit_digits ns: whole nanoseconds, or nullptr for read_stamp.
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
      __builtin_mul_overflow(static_cast<std::int64_t>(w), kNanoseconds[static_cast<std::size_t>(scale)], &ns))
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
StampDefect read_stamp(std::string_view text, char point, std::int64_t unit_ns, std::int64_t& out, std::size_t& offset,
                       double zero = 0);

}  // namespace libchar::csv

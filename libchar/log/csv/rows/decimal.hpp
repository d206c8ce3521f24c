#pragma once
// The nearest double to a decimal number w · 10^q with few digits, without std::from_chars: the
// arithmetic of the scalar tier (number.hpp).

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace libchar::csv {

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
  // 2^(127 + width) / divisor lies in [2^127, 2^128] because 2^(width-1) <= divisor < 2^width; n =
  // 0 is not used.
  Uint128 remainder = 0;
  Reciprocal r;
  r.shift = width - (n == 0 ? 1 : 0);
  Uint128 quotient = 0;
  for (int bit = 127 + r.shift; bit >= 0;
       --bit) {  // schoolbook division of a single set bit, one bit at a time
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
  for (int n = 0; n < kReciprocals; ++n)
    table[static_cast<std::size_t>(n)] = reciprocal_of_power_of_five(n);
  return table;
}();

inline constexpr std::array<double, 23> kPowerOfTen = {
    1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/// The nearest double to w / 10^n for 1 <= n <= 27; false when 128 bits do not decide the rounding.
inline bool divide_by_power_of_ten(std::uint64_t w, int n, double& out) {
  const Reciprocal& r = kReciprocal[static_cast<std::size_t>(n)];
  const int zeros = std::countl_zero(w);
  w <<= zeros;
  const Uint128 upper = static_cast<Uint128>(w) * r.bits.high;
  const Uint128 lower = static_cast<Uint128>(w) * r.bits.low;
  const Uint128 product =
      upper + static_cast<std::uint64_t>(lower >> 64U);  // top 128 of 192 bits, at most 2 too small
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

}  // namespace libchar::csv

#include "libchar/log/binary/number_type.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

namespace libchar {
namespace {

struct TypeName {
  std::string_view name;
  std::size_t size;
};
constexpr std::array<TypeName, kNumberTypes> kTypes = {{{"f16", 2},
                                                        {"f32", 4},
                                                        {"f64", 8},
                                                        {"i8", 1},
                                                        {"i16", 2},
                                                        {"i24", 3},
                                                        {"i32", 4},
                                                        {"i64", 8},
                                                        {"u8", 1},
                                                        {"u16", 2},
                                                        {"u32", 4},
                                                        {"u64", 8}}};

template <std::size_t size>
using Bits = std::conditional_t<
    size == 1, std::uint8_t,
    std::conditional_t<size == 2, std::uint16_t, std::conditional_t<size == 4, std::uint32_t, std::uint64_t>>>;

template <typename U>
U swapped(U bits) {
  if constexpr (sizeof(U) == 8) return __builtin_bswap64(bits);
  if constexpr (sizeof(U) == 4) return __builtin_bswap32(bits);
  if constexpr (sizeof(U) == 2) return __builtin_bswap16(bits);
  return bits;
}

// IEEE 754 binary16: 1 sign, 5 exponent (bias 15), 10 fraction bits; every value is exact in binary64.
double half_value(std::uint16_t bits) {
  const int exponent = (bits >> 10U) & 0x1F;
  const int fraction = bits & 0x3FF;
  double value = 0;
  if (exponent == 31)
    value = fraction == 0 ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
  else if (exponent == 0)
    value = std::ldexp(fraction, -24);
  else
    value = std::ldexp(fraction + 1024, exponent - 25);
  return (bits & 0x8000U) != 0 ? -value : value;
}

struct Half {
  std::uint16_t bits;
};

double to_double(Half half) { return half_value(half.bits); }

struct Triple {
  std::array<std::uint8_t, 3> bytes;  // the least significant first
};

double to_double(Triple t) {
  const std::uint32_t bits = t.bytes[0] | t.bytes[1] << 8U | t.bytes[2] << 16U;
  return static_cast<double>(static_cast<std::int32_t>(bits << 8U) / 256);
}
double to_double(float value) { return static_cast<double>(value); }
template <typename T>
double to_double(T value) {
  return static_cast<double>(value);
}

template <typename T, bool swap>
T load(const std::byte* from) {
  if constexpr (std::is_same_v<T, Triple>) {
    Triple t;
    std::memcpy(t.bytes.data(), from, t.bytes.size());
    if (swap) std::swap(t.bytes[0], t.bytes[2]);
    return t;
  } else {
    Bits<sizeof(T)> bits;
    std::memcpy(&bits, from, sizeof bits);
    return std::bit_cast<T>(swap ? swapped(bits) : bits);
  }
}

template <typename T, bool swap>
Rounded read_as(const std::byte* first, std::size_t stride, std::span<double> out) {
  const std::size_t n = out.size();
  double* const to = out.data();
  if (stride == sizeof(T)) {  // a constant stride lets the compiler use wide loads
    for (std::size_t i = 0; i < n; ++i) to[i] = to_double(load<T, swap>(first + i * sizeof(T)));
  } else {
    for (std::size_t i = 0; i < n; ++i) to[i] = to_double(load<T, swap>(first + i * stride));
  }
  Rounded rounded;
  if constexpr (std::is_integral_v<T> && sizeof(T) == 8) {
    constexpr double kEdge = 9007199254740992.0;  // 2^53: below it every integer is exact
    for (std::size_t i = 0; i < n; ++i) {
      if (std::abs(to[i]) < kEdge) continue;
      const T value = load<T, swap>(first + i * stride);
      // 2^63 or 2^64 came out of rounding up: converting it back would overflow.
      const bool fits = to[i] < std::ldexp(1.0, std::is_signed_v<T> ? 63 : 64);
      if (fits && static_cast<T>(to[i]) == value) continue;
      if (rounded.count++ == 0) rounded.first = i;
    }
  }
  return rounded;
}

template <typename T, bool swap>
std::optional<std::size_t> integers_as(const std::byte* first, std::size_t stride, std::span<std::int64_t> out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const T value = load<T, swap>(first + i * stride);
    if constexpr (std::is_same_v<T, std::uint64_t>) {
      if (value > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) return i;
    }
    out[i] = static_cast<std::int64_t>(value);
  }
  return std::nullopt;
}

// Calls `f` with a value of the C++ type behind `type`.
template <typename F>
auto with_type(NumberType type, F f) {
  switch (type) {
    case NumberType::f16:
      return f(Half{});
    case NumberType::f32:
      return f(float{});
    case NumberType::f64:
      return f(double{});
    case NumberType::i8:
      return f(std::int8_t{});
    case NumberType::i16:
      return f(std::int16_t{});
    case NumberType::i24:
      return f(Triple{});
    case NumberType::i32:
      return f(std::int32_t{});
    case NumberType::i64:
      return f(std::int64_t{});
    case NumberType::u8:
      return f(std::uint8_t{});
    case NumberType::u16:
      return f(std::uint16_t{});
    case NumberType::u32:
      return f(std::uint32_t{});
    case NumberType::u64:
      break;
  }
  return f(std::uint64_t{});
}

}  // namespace

static_assert(std::endian::native == std::endian::little,
              "byte orders are swapped relative to a little-endian machine");

std::size_t size_of(NumberType type) { return kTypes[static_cast<std::size_t>(type)].size; }
std::string_view name_of(NumberType type) { return kTypes[static_cast<std::size_t>(type)].name; }
bool is_float(NumberType type) { return type <= NumberType::f64; }

std::optional<NumberType> find_number_type(std::string_view name) {
  for (std::size_t i = 0; i < kTypes.size(); ++i)
    if (kTypes[i].name == name) return static_cast<NumberType>(i);
  return std::nullopt;
}

Rounded read_numbers(const std::byte* first, std::size_t stride, NumberFormat format, std::span<double> out) {
  if (format.type == NumberType::f64 && !format.big_endian && stride == sizeof(double)) {
    if (!out.empty()) std::memcpy(out.data(), first, out.size_bytes());
    return {};
  }
  return with_type(format.type, [&](auto example) {
    using T = decltype(example);
    return format.big_endian ? read_as<T, true>(first, stride, out) : read_as<T, false>(first, stride, out);
  });
}

std::optional<std::size_t> read_integers(const std::byte* first, std::size_t stride, NumberFormat format,
                                         std::span<std::int64_t> out) {
  return with_type(format.type, [&](auto example) -> std::optional<std::size_t> {
    using T = decltype(example);
    if constexpr (std::is_integral_v<T>) {
      return format.big_endian ? integers_as<T, true>(first, stride, out) : integers_as<T, false>(first, stride, out);
    } else {
      return 0;  // a programmer's mistake: no float is an exact stamp
    }
  });
}

void write_number(double value, NumberFormat format, std::byte* to) {
  if (format.type == NumberType::f32) {
    auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
    if (format.big_endian) bits = swapped(bits);
    std::memcpy(to, &bits, sizeof bits);
  } else {
    auto bits = std::bit_cast<std::uint64_t>(value);
    if (format.big_endian) bits = swapped(bits);
    std::memcpy(to, &bits, sizeof bits);
  }
}

bool looks_byte_swapped(std::span<const double> values, NumberType type) {
  if (type != NumberType::f64 && type != NumberType::f32) return false;
  const double limit = type == NumberType::f64 ? 1e100 : 1e25;
  const auto plausible = [](double x, double most) {
    return std::isfinite(x) && std::abs(x) < most && std::abs(x) > 1 / most;
  };
  std::size_t counted = 0, odd = 0;
  for (const double x : values) {
    if (x == 0 || std::isnan(x)) continue;
    ++counted;
    double other = 0;
    if (type == NumberType::f64)
      other = std::bit_cast<double>(swapped(std::bit_cast<std::uint64_t>(x)));
    else
      other = static_cast<double>(std::bit_cast<float>(swapped(std::bit_cast<std::uint32_t>(static_cast<float>(x)))));
    odd += !plausible(x, limit) && plausible(other, 1e20);
  }
  return counted > 0 && 2 * odd > counted;
}

}  // namespace libchar

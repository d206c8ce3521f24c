#pragma once
// Binary numbers as logs hold them: which types, how many bytes, and how they become doubles.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace libchar {

enum class NumberType { f16, f32, f64, i8, i16, i24, i32, i64, u8, u16, u32, u64 };
inline constexpr std::size_t kNumberTypes = 12;

struct NumberFormat {
  NumberType type = NumberType::f64;
  bool big_endian = false;
};

std::size_t size_of(NumberType type);
std::string_view name_of(NumberType type);  ///< "f64", "i16"…
std::optional<NumberType> find_number_type(std::string_view name);
bool is_float(NumberType type);

/// Numbers that a double cannot hold exactly (64-bit integers above 2^53) and that were rounded to nearest.
struct Rounded {
  std::uint64_t count = 0;
  std::size_t first = 0;  ///< position of the first of them
};

/// Reads out.size() numbers that stand `stride` bytes apart from `first` (no alignment needed).
Rounded read_numbers(const std::byte* first, std::size_t stride, NumberFormat format, std::span<double> out);

/// The same as exact 64-bit integers, for stamps; only for integer types. Returns the position of
/// the first u64 that does not fit, or nothing.
std::optional<std::size_t> read_integers(const std::byte* first, std::size_t stride, NumberFormat format,
                                         std::span<std::int64_t> out);

/// Writes one double as f32 or f64.
void write_number(double value, NumberFormat format, std::byte* to);

/// Would these values make sense read with the other byte order, and none as they are (magnitudes like 1e-315)?
bool looks_byte_swapped(std::span<const double> values, NumberType type);

}  // namespace libchar

#pragma once
// The header of a .npy file (NumPy enhancement proposal 1; versions 1.0, 2.0, 3.0): a Python
// literal, read by hand and never evaluated.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/log/binary/number_type.hpp"
#include "libchar/log/detail/row_source.hpp"

namespace libchar {

struct NpyField {
  std::string name;  ///< "" in an unstructured array
  NumberFormat number;
  std::uint64_t count = 1;  ///< numbers side by side (a sub-array field)
  bool array = false;       ///< declared with a shape: its columns are called NAME_0, NAME_1…
  std::uint64_t byte = 0;   ///< offset within the record
};

struct NpyHeader {
  int major = 1;
  std::vector<NpyField> fields;  ///< padding left out
  bool structured = false;
  bool fortran_order = false;
  std::vector<std::uint64_t> shape;
  std::uint64_t item_bytes = 0;  ///< of one element (one record when structured)
  std::uint64_t data_byte = 0;   ///< where the data begin in the file
};

inline constexpr std::size_t kMaxNpyHeader = 10000;
inline constexpr std::uint64_t kMaxColumns = detail::kMostChannels;

/// Reads the header from the first bytes of a file (at least 12 + kMaxNpyHeader of them, or all
/// there are) of `file_bytes` bytes. Throws Error(input) with the byte at fault.
NpyHeader parse_npy_header(std::string_view first_bytes, std::uint64_t file_bytes, const std::string& file);

}  // namespace libchar

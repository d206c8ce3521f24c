#pragma once
// Rows of an array whose elements stand in packed bytes: what .npz and MATLAB files have in common.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libchar/log/arrays/log_array.hpp"
#include "libchar/log/arrays/packed_bytes.hpp"

namespace libchar {

struct PackedArray {
  PackedStretch stretch;
  std::string name;             ///< for messages
  std::uint64_t data_byte = 0;  ///< of the first element, in the unpacked bytes
  std::uint64_t element_bytes = 0;
  std::optional<std::uint32_t> crc;  ///< of all unpacked bytes
  bool to_the_end =
      false;  ///< the elements are the last of a compressed stream, which ends in a checksum of its own
};

/// `file` and `consumed`, to which bytes of the file are added, outlive the cursor. Rows come in
/// constant memory in either order; columns that stand one after the other are inflated once for
/// each. Throws Error(input) E0462 for broken data.
std::unique_ptr<ArrayCursor> open_packed_array(const BinaryFile& file,
                                               const PackedArray& array,
                                               const ArrayRows& rows,
                                               const std::vector<std::uint64_t>& columns,
                                               std::uint64_t& consumed);

}  // namespace libchar

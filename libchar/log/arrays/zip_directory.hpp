#pragma once
// The directory of a ZIP archive (PKWARE APPNOTE 6.3): which members it has and where their bytes
// stand. Members are never written to a disk, so their names are names and nothing else.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/log/arrays/packed_array.hpp"

namespace libchar {

inline constexpr std::string_view kLocalMagic = "PK\x03\x04";  ///< in front of a member

struct ZipMember {
  std::string name;  ///< as it stands in the directory
  PackedStretch stretch;
  std::uint32_t crc = 0;
  std::string why_not;  ///< why it cannot be read ("is encrypted"); "" when it can
};

/// All members in the order of the directory. Throws Error(input) E0460 for what is no whole
/// archive, E0462 for members that claim more than deflate can hold or that overlap (bombs).
std::vector<ZipMember> read_zip_directory(const BinaryFile& file);

}  // namespace libchar

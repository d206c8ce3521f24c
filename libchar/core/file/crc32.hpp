#pragma once
// The checksum of zip, gzip, PNG and MCAP: CRC-32 (ISO 3309, reflected polynomial 0xEDB88320).

#include <cstddef>
#include <cstdint>
#include <span>

namespace libchar {

/// Of the bytes, going on from what `before` them gave.
std::uint32_t crc32_of(std::span<const std::byte> bytes, std::uint32_t before = 0);

}  // namespace libchar

#pragma once
// What chunks of robots' logs are packed with, and their checksum.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace libchar {

/// "" when this build reads chunks packed with `method` ("", "none", "lz4", "zstd", "bz2"); else a
/// sentence: built without, or unknown.
std::string why_not_packed(std::string_view method);

/// Most bytes of an unpacked chunk or message that are held in memory.
inline constexpr std::uint64_t kLargestChunk = std::uint64_t{256} << 20U;

/// Unpacks `packed` into `to`, which grows with what comes out and never beyond `most`. Returns
/// what is wrong ("" = the stream came to its end); `to` holds what came before that. `method` is
/// a supported compression (`why_not_packed` returns nothing for it), not "none".
std::string unpack(std::string_view method, std::span<const std::byte> packed, std::uint64_t most,
                   std::vector<std::byte>& to);

}  // namespace libchar

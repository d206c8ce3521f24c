#include "libchar/core/file/crc32.hpp"

#include "libchar_have.hpp"

#if LIBCHAR_HAVE_ZLIB
#include <zlib.h>
#else
#include <boost/crc.hpp>
#endif

namespace libchar {

#if !LIBCHAR_HAVE_ZLIB
namespace {

std::uint32_t reversed(std::uint32_t bits) {
  std::uint32_t out = 0;
  for (int k = 0; k < 32; ++k) out |= (bits >> k & 1U) << (31 - k);
  return out;
}

}  // namespace
#endif

std::uint32_t crc32_of(std::span<const std::byte> bytes, std::uint32_t before) {
#if LIBCHAR_HAVE_ZLIB
  return static_cast<std::uint32_t>(::crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
#else
  // Goes on from a result: the register is its complement, whose bits Boost takes in the other order.
  boost::crc_optimal<32, 0x04C11DB7, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc(reversed(~before));
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
#endif
}

}  // namespace libchar

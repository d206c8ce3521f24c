// The checksum of zip and MCAP.

#include "libchar/core/file/crc32.hpp"

#include <catch2/catch.hpp>
#include <string_view>

using namespace libchar;

TEST_CASE("CRC-32: the check value of its definition, in one piece and in two") {
  const std::string_view digits = "123456789";
  const auto bytes = std::as_bytes(std::span(digits.data(), digits.size()));
  CHECK(crc32_of(bytes) == 0xCBF43926U);
  CHECK(crc32_of(bytes.subspan(4), crc32_of(bytes.first(4))) == 0xCBF43926U);
  CHECK(crc32_of({}) == 0);
}

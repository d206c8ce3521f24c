#include "libchar/core/file/sha256.hpp"

#include <catch2/catch.hpp>
#include <string>

using libchar::Sha256;

namespace {

std::string digest(std::string_view bytes) {
  Sha256 sha;
  sha.update(bytes);
  return sha.finish();
}

std::string some_bytes(std::size_t n) {
  std::string bytes;
  unsigned state = 12345;
  for (std::size_t i = 0; i < n; ++i) {
    state = state * 1103515245U + 12345U;
    bytes += static_cast<char>(state >> 16U);
  }
  return bytes;
}

}  // namespace

TEST_CASE("sha256: the examples of FIPS 180-4 and of its test vectors") {
  CHECK(digest("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(digest("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(digest("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  CHECK(digest(std::string(1000000, 'a')) == "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST_CASE("sha256: the digest does not depend on how the bytes are cut") {
  for (const std::size_t size : {std::size_t{55}, std::size_t{56}, std::size_t{63}, std::size_t{64}, std::size_t{65},
                                 std::size_t{119}, std::size_t{1000}}) {
    const std::string bytes = some_bytes(size), whole = digest(bytes);
    for (const std::size_t step :
         {std::size_t{1}, std::size_t{7}, std::size_t{63}, std::size_t{64}, std::size_t{65}, std::size_t{200}}) {
      Sha256 sha;
      for (std::size_t at = 0; at < size; at += step) {
        sha.update(std::string_view(bytes).substr(at, step));
        sha.update("");
      }
      CHECK(sha.finish() == whole);
    }
  }
}

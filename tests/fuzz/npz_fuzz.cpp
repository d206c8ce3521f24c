// Any bytes as a .npz archive.

#include "tests/fuzz/topics_fuzz.hpp"
#include "tests/support/memory_log.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const test::MemoryLog log({reinterpret_cast<const char*>(data) + 1, size - 1});
  test::read_any_topics("npz", log.path(), 1 + data[0]);
  return 0;
}

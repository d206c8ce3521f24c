// Any bytes as a database of rosbag2: an Error or rows, the same rows in any blocks.

#include "tests/fuzz/topics_fuzz.hpp"
#include "tests/support/memory_log.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const test::MemoryLog log({reinterpret_cast<const char*>(data) + 1, size - 1});
  test::read_any_topics("db3", log.path(), 1 + data[0] % 8);
  return 0;
}

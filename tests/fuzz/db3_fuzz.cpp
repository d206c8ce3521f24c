// Any bytes as a database of rosbag2: an Error or rows, the same rows in any blocks.

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/fuzz/topics_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  // SQLite wants a file that has a name.
  const std::filesystem::path folder =
      std::filesystem::exists("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path();
  const std::filesystem::path path = folder / ("fuzz" + std::to_string(::getpid()) + ".db3");
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(data) + 1, static_cast<std::streamsize>(size - 1));
  test::read_any_topics("db3", path.string(), 1 + data[0] % 8);
  std::filesystem::remove(path);
  return 0;
}

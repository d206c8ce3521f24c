#pragma once
// A log in memory under a name in the file system: fuzzers read through the same door as users,
// without touching a disk.

#include <sys/mman.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <string_view>

namespace test {

class MemoryLog {
 public:
  explicit MemoryLog(std::string_view bytes) : descriptor_(::memfd_create("log", MFD_CLOEXEC)) {
    if (descriptor_ < 0) throw std::runtime_error("memfd_create failed");
    while (!bytes.empty()) {
      const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
      if (n <= 0) throw std::runtime_error("writing to memory failed");
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
  }
  MemoryLog(const MemoryLog&) = delete;
  MemoryLog& operator=(const MemoryLog&) = delete;
  ~MemoryLog() { ::close(descriptor_); }
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

}  // namespace test

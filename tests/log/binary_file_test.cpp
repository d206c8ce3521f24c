#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "libchar/core/error.hpp"
#include "libchar/log/binary/file.hpp"

using namespace libchar;

TEST_CASE("a file that is handed out in pieces is read whole, and nothing behind it is written") {
  // Files of the kernel come a page at a time.
  const char* const path = "/proc/kallsyms";
  std::ifstream file(path, std::ios::binary);
  std::string known(20000, '\0');
  file.read(known.data(), static_cast<std::streamsize>(known.size()));
  if (file.gcount() < 20000) return;  // a kernel that keeps them to itself
  std::vector<std::byte> bytes(60000, std::byte{0xA5});
  BinaryFile(path).read(0, std::span(bytes).first(known.size()));
  CHECK(std::equal(known.begin(), known.end(), bytes.begin(),
                   [](char a, std::byte b) { return static_cast<std::byte>(a) == b; }));
  CHECK(std::all_of(bytes.begin() + 20000, bytes.end(), [](std::byte b) { return b == std::byte{0xA5}; }));
}

TEST_CASE("a file that cannot be read any further names the byte where that is") {
  // The memory of this process as a file: behind a page that is there comes one that is not.
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  void* const two = ::mmap(nullptr, 2 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  REQUIRE(two != MAP_FAILED);
  const auto begin = reinterpret_cast<std::uintptr_t>(two);
  REQUIRE(::munmap(static_cast<char*>(two) + page, page) == 0);
  std::vector<std::byte> bytes(200);
  std::string where, what;
  try {
    BinaryFile("/proc/self/mem").read(begin + page - 100, bytes);
  } catch (const Error& error) {
    where = error.problem().where;
    what = error.problem().what;
  }
  ::munmap(two, page);
  CHECK(where == fmt::format("/proc/self/mem (byte {})", begin + page));
  CHECK_THAT(what, Catch::StartsWith("cannot be read"));
}

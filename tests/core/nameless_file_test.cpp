#include <fcntl.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cerrno>
#include <filesystem>

#include "libchar/core/file/unfinished_files.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

TEST_CASE("a file without a name is written and read, and leaves nothing in its folder") {
  const test::TemporaryFolder folder;
  const int file = open_nameless(folder.path());
  REQUIRE(file >= 0);
  CHECK(std::filesystem::is_empty(folder.path()));
  char back = 0;
  CHECK(::write(file, "x", 1) == 1);
  CHECK(::pread(file, &back, 1, 0) == 1);
  CHECK(back == 'x');
  CHECK((::fcntl(file, F_GETFD) & FD_CLOEXEC) != 0);
  ::close(file);
  CHECK(std::filesystem::is_empty(folder.path()));
  CHECK(open_nameless(folder / "nowhere") == -1);
  CHECK(errno == ENOENT);
}

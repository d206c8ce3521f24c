#include "libchar/core/file/unfinished_files.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "libchar/core/file/whole_file.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

/// What a child process says that did `work` and then what a signal's handler does.
template <class Work>
int discarded_by_child(const Work& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      work();
      ::_exit(static_cast<int>(discard_unfinished()));
    } catch (...) {
      ::_exit(99);
    }
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 100;
}

std::size_t files_in(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

}  // namespace

TEST_CASE("what is unfinished when a signal ends the program is removed, what has a name stays") {
  const test::TemporaryFolder folder;
  const std::string done = (folder.path() / "done").string(), other = (folder.path() / "other").string();
  CHECK(discarded_by_child([&] {
          WholeFile file(other);
          file.write("half");
          file.prepare();
          if (files_in(folder.path()) != 1) ::_exit(98);
          // The destructor must not be what removes it.
          ::_exit(static_cast<int>(discard_unfinished()));
        }) == static_cast<int>(Discarded::nothing_written));
  CHECK(files_in(folder.path()) == 0);

  CHECK(discarded_by_child([&] { write_whole_file(done, "whole"); }) == static_cast<int>(Discarded::some_written));
  CHECK(files_in(folder.path()) == 1);
}

TEST_CASE("outputs that get their names are not torn apart by a signal") {
  CHECK(discarded_by_child([] {
          const GivingNames naming;
          ::_exit(static_cast<int>(discard_unfinished()));
        }) == static_cast<int>(Discarded::not_now));
}

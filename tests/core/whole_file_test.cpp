#include "libchar/core/file/whole_file.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <csignal>
#include <thread>

#include "libchar/core/error.hpp"
#include "libchar/core/file/output_files.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

std::size_t entries(const test::TemporaryFolder& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder.path()), {}));
}

template <typename Work>
ErrorKind kind_of(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.problem().kind;
  }
  FAIL("no error");
  return ErrorKind::usage;
}

}  // namespace

TEST_CASE("a file has its whole content and its name after commit, and nothing before") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "a.txt").string(), large(1'000'003, 'x');
  {
    WholeFile file(path);
    file.write("0000 head\n");
    file.write(large);
    file.rewrite(0, "1234");
    CHECK_FALSE(std::filesystem::exists(path));
    file.commit();
    CHECK(file.path() == path);
  }
  CHECK(test::slurp(path) == "1234 head\n" + large);
  CHECK(entries(folder) == 1);
}

TEST_CASE("without commit there is no file, and an older one is as it was") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "a.txt").string();
  { WholeFile(path).write("lost"); }
  CHECK(entries(folder) == 0);
  write_whole_file(path, "old");
  {
    WholeFile file(path, true);
    file.write(std::string(1'000'000, 'n'));
  }
  CHECK(test::slurp(path) == "old");
  CHECK(entries(folder) == 1);
  write_whole_file(path, "new", true);
  CHECK(test::slurp(path) == "new");
  CHECK(entries(folder) == 1);
}

TEST_CASE("an existing file is not overwritten unasked, not even one that appeared meanwhile") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "a.txt").string();
  write_whole_file(path, "old");
  CHECK(kind_of([&] { write_whole_file(path, "new"); }) == ErrorKind::output);
  CHECK(test::slurp(path) == "old");
  const std::string other = (folder / "b.txt").string();
  {
    WholeFile late(other);
    late.write("late");
    write_whole_file(other, "first");
    CHECK(kind_of([&] { late.commit(); }) == ErrorKind::output);
  }
  CHECK(test::slurp(other) == "first");
  CHECK(entries(folder) == 2);
}

TEST_CASE("folders, missing folders and a full device are errors of output") {
  const test::TemporaryFolder folder;
  CHECK(kind_of([&] { WholeFile(folder.path().string()); }) == ErrorKind::output);
  CHECK(kind_of([&] { WholeFile((folder / "no/such/folder").string()); }) == ErrorKind::output);
  CHECK(kind_of([&] { WholeFile(""); }) == ErrorKind::output);
  CHECK(kind_of([] { write_whole_file("/dev/full", "x", true); }) == ErrorKind::output);
  CHECK(kind_of([] { write_whole_file("/dev/full", std::string(1'000'000, 'x')); }) == ErrorKind::output);
  CHECK_NOTHROW(write_whole_file("/dev/null", "x"));
  CHECK(entries(folder) == 0);
}

TEST_CASE("a file that grows past the limit fails, leaves the old one and nothing else") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "a.txt").string();
  write_whole_file(path, "old");
  struct rlimit before {};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
  struct rlimit small = before;
  small.rlim_cur = 100'000;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &small) == 0);
  const ErrorKind kind = kind_of([&] { write_whole_file(path, std::string(1'000'000, 'x'), true); });
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  CHECK(kind == ErrorKind::output);
  CHECK(test::slurp(path) == "old");
  CHECK(entries(folder) == 1);
}

TEST_CASE("a moved file is committed once") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "a.txt").string();
  WholeFile first(path);
  first.write("one ");
  WholeFile second(std::move(first));
  second.write("two");
  second.commit();
  CHECK(test::slurp(path) == "one two");
}

TEST_CASE("an input is never its own output, under no name") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "a.txt").string(), link = (folder / "b.txt").string(),
                    other = (folder / "c.txt").string();
  write_whole_file(path, "x");
  std::filesystem::create_symlink(path, link);
  std::filesystem::create_hard_link(path, folder / "d.txt");
  CHECK(kind_of([&] { refuse_same_file(path, path); }) == ErrorKind::output);
  CHECK(kind_of([&] { refuse_same_file(path, link); }) == ErrorKind::output);
  CHECK(kind_of([&] { refuse_same_file((folder / "d.txt").string(), path); }) == ErrorKind::output);
  CHECK_NOTHROW(refuse_same_file(path, other));
  CHECK_NOTHROW(refuse_same_file("-", path));
  CHECK_NOTHROW(refuse_same_file("/dev/null", "/dev/null"));
}

TEST_CASE("what replaces a file has its rights, and a read-only one is not replaced") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "a.txt").string();
  const auto rights = [&] {
    struct stat status {};
    REQUIRE(::stat(path.c_str(), &status) == 0);
    return status.st_mode & 07777U;
  };
  for (const unsigned mode : {0600U, 0640U, 0666U, 0755U}) {
    write_whole_file(path, "old", true);
    REQUIRE(::chmod(path.c_str(), mode) == 0);
    write_whole_file(path, "new", true);
    CHECK(rights() == mode);
  }
  REQUIRE(::chmod(path.c_str(), 0444) == 0);
  CHECK(kind_of([&] { write_whole_file(path, "newer", true); }) == ErrorKind::output);
  CHECK(kind_of([&] { check_output(path, true); }) == ErrorKind::output);
  CHECK(test::slurp(path) == "new");
  CHECK(rights() == 0444);
  CHECK(entries(folder) == 1);
}

TEST_CASE("an open file of this process is written through, under each of its names") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "stdout.txt").string(), link = (folder / "link").string();
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  REQUIRE(file >= 0);
  REQUIRE(::write(file, "before ", 7) == 7);
  const std::string number = std::to_string(file);
  std::filesystem::create_symlink("/dev/fd/" + number, link);
  for (const std::string& name : {"/dev/fd/" + number, "/proc/self/fd/" + number, link}) {
    CHECK(writes_through(name));
    CHECK_NOTHROW(check_output(name, false));
    WholeFile through(name, true);
    through.write("0123 ");
    through.rewrite(0, "abcd");
    through.write(std::string(600'000, 'x'));
    through.rewrite(1, "BC");
    through.commit();
  }
  ::close(file);
  const std::string written = "aBCd " + std::string(600'000, 'x');
  CHECK(test::slurp(path) == "before " + written + written + written);
  CHECK(std::filesystem::is_symlink(link));
  CHECK_FALSE(writes_through(path));
  CHECK(entries(folder) == 2);
}

TEST_CASE("a pipe is not opened to see whether it could be, and cannot be gone back in") {
  const test::TemporaryFolder folder;
  const std::string pipe = (folder / "pipe").string();
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  CHECK_NOTHROW(check_output(pipe, false));  // would wait for a reader
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  WholeFile file(pipe);
  file.write("0000");
  file.rewrite(0, "1234");
  file.commit();
  char got[8] = {};
  CHECK(::read(reader, got, sizeof got) == 4);
  CHECK(std::string(got) == "1234");
  std::atomic<bool> written = false;
  std::thread drain([&] {  // nothing to read does not mean that nothing will come: the writer may not have begun
    char bytes[65536];
    while (!written)
      if (::read(reader, bytes, sizeof bytes) <= 0) std::this_thread::yield();
  });
  {
    WholeFile large(pipe);
    large.write(std::string(1'000'000, 'x'));
    CHECK(kind_of([&] { large.rewrite(0, "1234"); }) == ErrorKind::output);
  }
  written = true;
  drain.join();
  ::close(reader);
  CHECK(entries(folder) == 1);
}

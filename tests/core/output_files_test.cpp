#include "libchar/core/file/output_files.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "libchar/core/detail/output_journal.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/file/file_owner.hpp"
#include "tests/support/code_of.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

namespace fs = std::filesystem;

void put_text(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

/// report.json, which names all, and one file for each name.
std::vector<OutputFile> set_of(const fs::path& folder, const std::vector<std::string>& names) {
  std::vector<OutputFile> outputs = {{(folder / "report.json").string(), ""}};
  for (const std::string& name : names) outputs.push_back({(folder / name).string(), name + "\n"});
  Json document;
  name_files(document, outputs);
  outputs[0].text = document.dump();
  return outputs;
}

}  // namespace

TEST_CASE("what an earlier run named and the new one has not is removed, and nothing else") {
  const test::TemporaryFolder folder;
  write_outputs(set_of(folder.path(), {"a.yaml", "b.yaml"}), folder.path(), {}, false);
  put_text(folder / "mine.yaml", "mine");
  const auto removed = write_outputs(set_of(folder.path(), {"a.yaml"}), folder.path(), {}, true);
  CHECK(removed == std::vector<std::string>{"b.yaml"});
  CHECK(names_in(folder.path()) == std::set<std::string>{"a.yaml", "mine.yaml", "report.json"});
}

TEST_CASE("a document that is not replaced removes nothing, and no name leads out of the folder") {
  const test::TemporaryFolder folder;
  fs::create_directory(folder / "in");
  put_text(folder / "outside.txt", "outside");
  put_text(folder / "in" / "mine.txt", "mine");
  put_text(folder / "in" / "report.json", R"({"files": ["report.json", "../outside.txt", "..", "", ".", 3]})");
  put_text(folder / "in" / "runs.json", R"({"files": ["runs.json", "mine.txt"]})");
  CHECK(write_outputs(set_of(folder / "in", {}), folder / "in", {}, true).empty());
  CHECK(fs::exists(folder / "outside.txt"));
  CHECK(names_in(folder / "in") == std::set<std::string>{"mine.txt", "report.json", "runs.json"});
}

TEST_CASE("a file that the new document names is not removed, whoever wrote it") {
  const test::TemporaryFolder folder;
  const auto once = [&](bool force) {
    std::vector<OutputFile> outputs = {{(folder / "report.json").string(), ""}};
    outputs[0].text = Json{{"files", {"report.json", "estimates.csv"}}}.dump();
    WholeFile estimates((folder / "estimates.csv").string(), force);
    estimates.write("1\n");
    return write_outputs(outputs, folder.path(), {}, force, {&estimates});
  };
  once(false);
  CHECK(once(true).empty());
  CHECK(fs::exists(folder / "estimates.csv"));
}

TEST_CASE("an input of the run is not removed as an earlier run's file") {
  const test::TemporaryFolder folder;
  write_outputs(set_of(folder.path(), {"b.yaml"}), folder.path(), {}, false);
  const std::string input = (folder / "b.yaml").string();
  CHECK(test::code_of([&] { write_outputs(set_of(folder.path(), {}), folder.path(), {input}, true); }) == "E0504");
  CHECK(fs::exists(input));
}

TEST_CASE("a run that was killed between two names is finished by the next, and read by nobody before") {
  const test::TemporaryFolder folder;
  write_outputs(set_of(folder.path(), {"a.yaml", "b.yaml"}), folder.path(), {}, false);
  // As left by a kill after the first of two names: a.yaml is new, report.json and the removal of b.yaml are to come.
  put_text(folder / "a.yaml", "new a");
  put_text(folder / "report.json.libchar-tmp-1-0", R"({"files": ["report.json", "a.yaml"]})");
  journal_file(folder.path(),
               {{{"a.yaml.libchar-tmp-1-0", "a.yaml"}, {"report.json.libchar-tmp-1-0", "report.json"}}, {"b.yaml"}})
      .write();
  CHECK(test::code_of([&] { refuse_interrupted(folder.path()); }) == "E0516");
  finish_journal(folder.path());
  CHECK(names_in(folder.path()) == std::set<std::string>{"a.yaml", "report.json"});
  CHECK(test::slurp(folder / "a.yaml") == "new a");
  CHECK(test::slurp(folder / "report.json").find("b.yaml") == std::string::npos);
  CHECK_NOTHROW(refuse_interrupted(folder.path()));
}

TEST_CASE("a journal that leads out of its folder, or is none, is refused") {
  const test::TemporaryFolder folder;
  for (const char* text : {R"({"rename": [["a", "../b"]], "remove": []})", R"({"rename": [], "remove": [".."]})",
                           R"({"rename": 3})", "", "{"}) {
    put_text(folder / ".libchar-outputs.json", text);
    CHECK(test::code_of([&] { finish_journal(folder.path()); }) == "E0514");
  }
}

TEST_CASE("two runs on one folder: the second waits for the first, and says so where that lasts") {
  const test::TemporaryFolder folder;
  auto other = std::make_unique<detail::FolderLock>(folder.path());
  CHECK(test::code_of([&] { const detail::FolderLock lock(folder.path(), 0.05); }) == "E0515");
  std::thread first([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    CHECK(names_in(folder.path()) == std::set<std::string>{detail::kLockFile});  // nothing yet
    other.reset();
  });
  write_outputs(set_of(folder.path(), {"a.yaml"}), folder.path(), {}, false);
  first.join();
  CHECK(names_in(folder.path()) == std::set<std::string>{"a.yaml", "report.json"});
}

TEST_CASE("data and description come together or not at all, whatever stood there before") {
  const test::TemporaryFolder folder;
  const fs::path data = folder / "x.bin", text = folder / "x.bin.json";
  const auto commit = [&](const std::string& content, bool force) {
    return test::code_of([&] {
      WholeFile a(data.string(), force), b(text.string(), force);
      a.write(content);
      b.write(content);
      if (content == "blocked") fs::create_directory(text);  // what comes in between
      commit_together({&a, &b});
    });
  };
  CHECK(commit("blocked", false) == "E0501");
  fs::remove(text);
  CHECK(names_in(folder.path()).empty());
  CHECK(commit("one", false) == "");
  CHECK(commit("two", false) == "E0503");
  CHECK(test::slurp(data) + test::slurp(text) == "oneone");
  CHECK(commit("two", true) == "");
  CHECK(test::slurp(data) + test::slurp(text) == "twotwo");
  fs::remove(text);
  CHECK(commit("blocked", true) == "E0501");
  CHECK(test::slurp(data) == "two");
  fs::remove(text);
  CHECK(names_in(folder.path()) == std::set<std::string>{"x.bin"});
}

TEST_CASE("files of two folders and devices are committed together as far as there are sets") {
  const test::TemporaryFolder folder;
  fs::create_directory(folder / "in");
  WholeFile a((folder / "a").string()), b((folder / "in" / "b").string()), c("/dev/null");
  for (WholeFile* file : {&a, &b, &c}) file->write("x");
  commit_together({&a, &b, &c});
  CHECK(names_in(folder.path()) == std::set<std::string>{"a", "in"});
  CHECK(names_in(folder / "in") == std::set<std::string>{"b"});
}

TEST_CASE("one of a pair that an interrupted run has left is not read, its neighbours are") {
  const test::TemporaryFolder folder;
  journal_file(folder.path(), {{{"log.bin.libchar-tmp-1-0", "log.bin"}}, {"old.yaml"}}).write();
  CHECK(test::code_of([&] { refuse_interrupted(folder / "log.bin"); }) == "E0516");
  CHECK(test::code_of([&] { refuse_interrupted(folder / "old.yaml"); }) == "E0516");
  CHECK_NOTHROW(refuse_interrupted(folder / "other.bin"));
}

TEST_CASE("the next run that replaces a file removes what a killed one of this place has left of it") {
  const test::TemporaryFolder folder;
  const std::string here = "a.csv.libchar-tmp-" + detail::place_of_process();
  put_text(folder / (here + "-999999999-0"), "litter");
  for (const char* other : {"a.csv.libchar-tmp-mine", "a.csv.libchar-tmp-0123456789abcdef-7-0"})
    put_text(folder / other, "not ours");
  write_whole_file((folder / "a.csv").string(), "new");
  write_whole_file((folder / "a.csv").string(), "newer", true);
  CHECK(names_in(folder.path()) ==
        std::set<std::string>{"a.csv", "a.csv.libchar-tmp-mine", "a.csv.libchar-tmp-0123456789abcdef-7-0"});
}

TEST_CASE("a temporary file of another place is litter when it is old and nobody holds it") {
  const test::TemporaryFolder folder;
  const fs::path other = folder / "a.csv.libchar-tmp-0123456789abcdef-7-0", earlier = folder / "a.csv.libchar-tmp-7-0";
  for (const fs::path& file : {other, earlier}) {
    put_text(file, "x");
    detail::remove_litter(folder.path().string());
    CHECK(fs::exists(file));  // its owner may not have come to lock it
    fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(48));
    const int owner = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
    REQUIRE(detail::lock_whole_file(owner) == detail::Lock::taken);
    detail::remove_litter(folder.path().string());
    CHECK(fs::exists(file));
    ::close(owner);
    detail::remove_litter(folder.path().string());
    CHECK_FALSE(fs::exists(file));
  }
}

TEST_CASE("a file being written is locked until it has its name") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "a.csv").string();
  write_whole_file(path, "old");
  WholeFile file(path, true);
  file.write("new");
  file.prepare();
  CHECK(detail::owner_by_name(fs::path(file.temporary()).filename().string())->place == detail::place_of_process());
  const int other = ::open(file.temporary().c_str(), O_RDWR | O_CLOEXEC);
  CHECK(detail::lock_whole_file(other) == detail::Lock::of_another);
  ::close(other);
  file.commit();
  CHECK(test::slurp(path) == "new");
}

TEST_CASE("a temporary file that somebody took away is an error, not a finished file") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "a.csv").string();
  write_whole_file(path, "old");
  WholeFile file(path, true);
  file.write("new");
  file.prepare();
  fs::remove(file.temporary());
  CHECK(test::code_of([&] { file.commit(); }) == "E0501");
  CHECK(test::slurp(path) == "old");
}

TEST_CASE("a journal whose files are gone says so, one whose files have their names is finished") {
  const test::TemporaryFolder folder;
  OutputJournal journal;
  for (const char* name : {"a", "b"}) {
    put_text(folder / (std::string(name) + ".tmp"), std::string("new ") + name);
    journal.rename.push_back(waiting_file(folder.path(), std::string(name) + ".tmp", name));
  }
  put_text(folder / "b", "old");
  const auto interrupted = [&] { journal_file(folder.path(), journal).write(); };
  interrupted();
  fs::rename(folder / "a.tmp", folder / "a");  // killed here
  fs::remove(folder / "b.tmp");
  CHECK(test::code_of([&] { finish_journal(folder.path()); }) == "E0525");
  CHECK(test::slurp(folder / "b") == "old");
  CHECK(has_journal(folder.path()));
  put_text(folder / "b.tmp", "new b");
  finish_journal(folder.path());
  CHECK(names_in(folder.path()) == std::set<std::string>{"a", "b"});
  CHECK(test::slurp(folder / "b") == "new b");
  interrupted();  // killed before the journal was removed; both have their names
  journal.rename[1].bytes = -1;
  interrupted();
  CHECK_NOTHROW(finish_journal(folder.path()));
}

TEST_CASE("what a killed run of several files waits for is no litter to a single file's run") {
  const test::TemporaryFolder folder;
  const std::string waiting = "a.libchar-tmp-" + detail::place_of_process() + "-999999999-0";
  put_text(folder / waiting, "new");
  put_text(folder / "c", "old");
  OutputJournal journal;
  journal.rename.push_back(waiting_file(folder.path(), waiting, "a"));
  journal_file(folder.path(), journal).write();
  write_whole_file((folder / "c").string(), "newer", true);
  CHECK(test::slurp(folder / "a") == "new");
  CHECK(names_in(folder.path()) == std::set<std::string>{"a", "c"});
}

TEST_CASE("who waits for a folder is told whose it is, and a lock that a kill has left is taken") {
  const test::TemporaryFolder folder;
  {
    const detail::FolderLock first(folder.path());
    CHECK(first.held());
    CHECK(names_in(folder.path()) == std::set<std::string>{detail::kLockFile});
    try {
      const detail::FolderLock second(folder.path(), 0.01);
      FAIL("both");
    } catch (const Error& error) {
      CHECK_THAT(error.problem().what,
                 Catch::Contains("process " + std::to_string(::getpid())) && Catch::Contains("since 2"));
    }
  }
  CHECK(names_in(folder.path()).empty());
  put_text(folder / detail::kLockFile, "left by a kill");
  CHECK(detail::FolderLock(folder.path(), 0).held());
  CHECK(names_in(folder.path()).empty());
}

TEST_CASE("a lock is no way to somebody's file: links and other names of one are left as they are") {
  const test::TemporaryFolder folder;
  put_text(folder / "mine", "mine");
  fs::create_symlink("mine", folder / detail::kLockFile);
  CHECK(test::code_of([&] { const detail::FolderLock lock(folder.path(), 0); }) == "E0501");
  fs::remove(folder / detail::kLockFile);
  fs::create_hard_link(folder / "mine", folder / detail::kLockFile);
  CHECK(detail::FolderLock(folder.path(), 0).held());
  CHECK(test::slurp(folder / "mine") == "mine");
}

TEST_CASE("killed at any moment, the next run leaves a whole set and no litter") {
  // The child is killed after a growing number of microseconds, wherever that is; every third is let run to its end.
  for (int trial = 0; trial < 60; ++trial) {
    const test::TemporaryFolder folder;
    write_outputs(set_of(folder.path(), {"old.yaml", "both.yaml"}), folder.path(), {}, false);
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      write_outputs(set_of(folder.path(), {"both.yaml", "new.yaml"}), folder.path(), {}, true);
      ::_exit(0);
    }
    ::usleep(static_cast<useconds_t>(40 * trial));
    if (trial % 3 != 0) ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    write_outputs(set_of(folder.path(), {"both.yaml", "last.yaml"}), folder.path(), {}, true);
    CHECK(names_in(folder.path()) == std::set<std::string>{"both.yaml", "last.yaml", "report.json"});
  }
}

#include "libchar/core/detail/output_journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "libchar/core/document/json.hpp"
#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"

namespace libchar {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostJournalBytes = std::size_t{1} << 24U;

fs::path journal_of(const fs::path& folder) {
  return folder / ".libchar-outputs.json";
}

constexpr const char* kRunAgain = "run it again: it first finishes what this run has begun";

Refusal failure_on(const fs::path& path, const char* doing) {
  return output_error("E0501", path.string()).says("cannot {}: {}", doing, std::strerror(errno));
}

void remove_file(const fs::path& path, const char* doing) {
  // Twice, as names are given.
  if (::unlink(path.c_str()) != 0 && errno != ENOENT && ::unlink(path.c_str()) != 0)
    throw failure_on(path, doing).hint(kRunAgain);
}

/// The journal is a file in somebody's folder: no name in it leads out of that folder.
std::string name_in(const Json& value) {
  const auto name = value.get<std::string>();
  if (name.empty() || name == "." || name == ".." || name.find('/') != std::string::npos)
    throw std::invalid_argument(name);
  return name;
}

OutputJournal read_journal(const fs::path& folder) {
  const fs::path path = journal_of(folder);
  const std::string text = file_text(path.string(), kMostJournalBytes);
  try {
    const Json document = Json::parse(text);
    OutputJournal journal;
    for (const Json& pair : document.at("rename"))
      journal.rename.emplace_back(name_in(pair.at(0)), name_in(pair.at(1)));
    for (const Json& name : document.at("remove")) journal.remove.push_back(name_in(name));
    return journal;
  } catch (const std::exception&) {
    throw output_error("E0514", path.string())
        .says("is not a list of outputs that an interrupted run has left")
        .hint("remove it");
  }
}

}  // namespace

void JournalFile::write() const {
  write_whole_file(path, text, true);
}

bool JournalFile::there() const noexcept {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0;
}

JournalFile journal_file(const fs::path& folder, const OutputJournal& journal) {
  Json document = {{"rename", Json::array()}, {"remove", Json(journal.remove)}};
  for (const auto& [from, to] : journal.rename)
    document["rename"].push_back(Json::array({from, to}));
  return {journal_of(folder).string(), document.dump() + "\n"};
}

void run_journal(const fs::path& folder, const OutputJournal& journal) {
  bool begun = false;
  for (const auto& [from, to] : journal.rename) {
    const fs::path source = folder / from, target = folder / to;
    // A second attempt: what failed once may have been a signal or a busy server.
    if (::rename(source.c_str(), target.c_str()) == 0 || errno == ENOENT ||
        ::rename(source.c_str(), target.c_str()) == 0) {
      begun = true;
      continue;
    }
    const int error = errno;
    if (!begun) ::unlink(journal_of(folder).c_str());
    errno = error;
    throw failure_on(target, "rename into place").hint(begun ? kRunAgain : "");
  }
  for (const std::string& name : journal.remove)
    remove_file(folder / name, "remove this file of an earlier run");
  sync_folder(folder.string());
  remove_file(journal_of(folder), "remove this list of what was to be done");
}

void finish_journal(const fs::path& folder) {
  if (has_journal(folder)) run_journal(folder, read_journal(folder));
}

bool has_journal(const fs::path& folder) {
  struct stat status {};
  if (::lstat(journal_of(folder).c_str(), &status) == 0) return true;
  // Where there is no folder, or one that may not be looked into, there is nothing to finish.
  if (errno == ENOENT || errno == ENOTDIR) return false;
  throw failure_on(journal_of(folder), "look for this list of what an interrupted run has left");
}

bool journal_names(const fs::path& folder, const std::string& name) {
  if (!has_journal(folder)) return false;
  const OutputJournal journal = read_journal(folder);
  const auto renamed = [&](const auto& pair) { return pair.second == name; };
  return std::any_of(journal.rename.begin(), journal.rename.end(), renamed) ||
         std::find(journal.remove.begin(), journal.remove.end(), name) != journal.remove.end();
}

FolderLock::FolderLock(const fs::path& folder, double wait_s)
    : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0) return;  // who may not read a folder may still write into it
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(wait_s);
  for (bool late = false;; late = Clock::now() > end) {
    // Where a file system has no locks there is none.
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    if (late) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ::close(descriptor_);
  throw output_error("E0515", folder.string())
      .says("another run is writing its results into this folder")
      .hint("wait for it or choose another folder");
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace libchar

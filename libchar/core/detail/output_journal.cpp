#include "libchar/core/detail/output_journal.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "libchar/core/document/json.hpp"
#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostJournalBytes = std::size_t{1} << 24U;

fs::path journal_of(const fs::path& folder) { return folder / ".libchar-outputs.json"; }

constexpr const char* kRunAgain = "run it again: it first finishes what this run has begun";

Refusal failure_on(const fs::path& path, const char* doing) {
  return output_error("E0501", path.string()).says("cannot {}: {}", doing, std::strerror(errno));
}

void remove_file(const fs::path& path, const char* doing) {
  // Twice, as names are given.
  if (::unlink(path.c_str()) != 0 && errno != ENOENT && ::unlink(path.c_str()) != 0)
    throw failure_on(path, doing).hint(kRunAgain);
}

WaitingFile described(const struct stat& status) {
  constexpr std::int64_t kNanoseconds = 1'000'000'000;
  WaitingFile out;
  out.bytes = status.st_size;
  out.changed_ns = status.st_mtim.tv_sec * kNanoseconds + status.st_mtim.tv_nsec;
  out.number = static_cast<std::int64_t>(status.st_ino);
  return out;
}

/// The journal is a file in somebody's folder: no name in it leads out of that folder.
std::string name_in(const Json& value) {
  const auto name = value.get<std::string>();
  if (name.empty() || name == "." || name == ".." || name.find('/') != std::string::npos)
    throw std::invalid_argument(name);
  return name;
}

WaitingFile waiting_in(const Json& value) {
  WaitingFile out{name_in(value.at(0)), name_in(value.at(1))};
  if (value.size() == 2) return out;
  out.bytes = value.at(2).get<std::int64_t>();
  out.changed_ns = value.at(3).get<std::int64_t>();
  out.number = value.at(4).get<std::int64_t>();
  return out;
}

/// What the journal wants to move has been moved: the file that waited has the name. A renamed file keeps its
/// time of change; a copy of the folder need not keep its number, nor a server.
bool is_in_place(const fs::path& target, const WaitingFile& waiting) {
  struct stat status {};
  if (::lstat(target.c_str(), &status) != 0) return false;
  const WaitingFile there = described(status);
  return waiting.bytes < 0 ||
         (there.bytes == waiting.bytes && (there.changed_ns == waiting.changed_ns || there.number == waiting.number));
}

Refusal lost(const fs::path& folder, const WaitingFile& waiting, bool begun) {
  Refusal refusal =
      output_error("E0525", (folder / waiting.name).string())
          .says("is lost: {}, under which it waited on the disk, is not there", printable(waiting.temporary));
  if (!begun) return refusal.hint("run it again");
  return refusal.hint("results there may be of two runs; remove {}, then run it again",
                      printable(journal_of(folder).string()));
}

OutputJournal read_journal(const fs::path& folder) {
  const fs::path path = journal_of(folder);
  const std::string text = file_text(path.string(), kMostJournalBytes);
  try {
    const Json document = detail::parse_loose_json(text);
    OutputJournal journal;
    for (const Json& waiting : document.at("rename")) journal.rename.push_back(waiting_in(waiting));
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
  WholeFile file(path, true);
  file.write(text);
  file.commit_in_locked_folder();
  sync_folder(fs::path(path).parent_path().string());
}

bool JournalFile::there() const noexcept {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0;
}

JournalFile journal_file(const fs::path& folder, const OutputJournal& journal) {
  Json document = {{"rename", Json::array()}, {"remove", Json(journal.remove)}};
  for (const WaitingFile& one : journal.rename)
    document["rename"].push_back(one.bytes < 0
                                     ? Json::array({one.temporary, one.name})
                                     : Json::array({one.temporary, one.name, one.bytes, one.changed_ns, one.number}));
  return {journal_of(folder).string(), document.dump() + "\n"};
}

WaitingFile waiting_file(const fs::path& folder, const std::string& temporary, const std::string& name) {
  struct stat status {};
  if (::lstat((folder / temporary).c_str(), &status) != 0) throw failure_on(folder / name, "find its temporary file");
  WaitingFile out = described(status);
  out.temporary = temporary;
  out.name = name;
  return out;
}

void run_journal(const fs::path& folder, const OutputJournal& journal) {
  bool begun = false;
  for (const WaitingFile& one : journal.rename) {
    const fs::path source = folder / one.temporary, target = folder / one.name;
    // A second attempt: what failed once may have been a signal or a busy server.
    if (::rename(source.c_str(), target.c_str()) == 0 || (errno == ENOENT && is_in_place(target, one)) ||
        ::rename(source.c_str(), target.c_str()) == 0) {
      begun = true;
      continue;
    }
    const int error = errno;
    if (!begun) ::unlink(journal_of(folder).c_str());
    if (error == ENOENT) throw lost(folder, one, begun);
    errno = error;
    throw failure_on(target, "rename into place").hint(begun ? kRunAgain : "");
  }
  for (const std::string& name : journal.remove) remove_file(folder / name, "remove this file of an earlier run");
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
  const auto renamed = [&](const WaitingFile& waiting) { return waiting.name == name; };
  return std::any_of(journal.rename.begin(), journal.rename.end(), renamed) ||
         std::find(journal.remove.begin(), journal.remove.end(), name) != journal.remove.end();
}

}  // namespace libchar

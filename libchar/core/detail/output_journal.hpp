#pragma once
// What a set of output files still has to do once all of it is on disk: written down before the first file gets its name, so that an
// interrupted run can be finished by the next one.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace libchar {

struct OutputJournal {
  std::vector<std::pair<std::string, std::string>>
      rename;                       ///< temporary name, name; both in the folder
  std::vector<std::string> remove;  ///< names of an earlier run's files that the set does not have
};

/// The file that it is: made before anything is written, so that memory for it is refused while nothing has been done.
struct JournalFile {
  std::string path, text;
  /// On disk when it returns. Throws Error(output).
  void write() const;
  bool there() const noexcept;
};
JournalFile journal_file(const std::filesystem::path& folder, const OutputJournal& journal);

/// Does what was written down and removes the journal. What is done already is passed over, so that it can be done again after a kill.
/// Throws Error(output) where a name cannot be given: then the journal stays, unless nothing has been done yet.
void run_journal(const std::filesystem::path& folder, const OutputJournal& journal);

/// Does what the folder's journal says, as `run_journal`; nothing where there is none.
void finish_journal(const std::filesystem::path& folder);

/// Whether a run was interrupted while its files got their names. Throws Error(output) where that cannot be known.
bool has_journal(const std::filesystem::path& folder);

/// Whether it was to change the file of this name.
bool journal_names(const std::filesystem::path& folder, const std::string& name);

/// One writer at a time: a lock on the folder itself, which ends with the process. Waits for another run's, which takes milliseconds;
/// throws Error(output) where that lasts longer than `wait_s`.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder, double wait_s = 10);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  int descriptor_ = -1;
};

}  // namespace libchar

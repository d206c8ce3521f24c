#pragma once
// What a set of output files still has to do once all of it is on disk: written down before the first file gets its
// name, so that an interrupted run can be finished by the next one.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace libchar {

/// One file that waits for its name; both names are in the folder. Its size and the time of its last change
/// tell it from an older one under that name; where they are not known (journals of earlier versions) any file
/// there is taken for it.
struct WaitingFile {
  std::string temporary, name;
  std::int64_t bytes = -1, changed_ns = 0, number = 0;
};

struct OutputJournal {
  std::vector<WaitingFile> rename;
  std::vector<std::string> remove;  ///< names of an earlier run's files that the set does not have
};

/// The file that it is: made before anything is written, so that memory for it is refused while nothing has been done.
struct JournalFile {
  std::string path, text;
  /// On disk when it returns. The folder is locked. Throws Error(output).
  void write() const;
  bool there() const noexcept;
};
JournalFile journal_file(const std::filesystem::path& folder, const OutputJournal& journal);

/// A file as it lies there now. Throws Error(output) where it does not.
WaitingFile waiting_file(const std::filesystem::path& folder, const std::string& temporary, const std::string& name);

/// Does what was written down and removes the journal. What is done already is passed over, so that it can be done
/// again after a kill. Throws Error(output) where a name cannot be given, or where a file is under neither of its
/// names: then the journal stays, unless nothing has been done yet.
void run_journal(const std::filesystem::path& folder, const OutputJournal& journal);

/// Does what the folder's journal says, as `run_journal`; nothing where there is none.
void finish_journal(const std::filesystem::path& folder);

/// Whether a run was interrupted while its files got their names. Throws Error(output) where that cannot be known.
bool has_journal(const std::filesystem::path& folder);

/// Whether it was to change the file of this name.
bool journal_names(const std::filesystem::path& folder, const std::string& name);

}  // namespace libchar

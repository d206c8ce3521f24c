#pragma once
// One writer at a time gives names in a folder: on this machine, in its containers, and on others that share
// the folder.

#include <filesystem>
#include <string>
#include <vector>

namespace libchar::detail {

/// The file in the folder that is locked while files get their names. It says whose it is, and goes with its
/// owner's work.
inline constexpr const char* kLockFile = ".libchar-lock";

class FolderLock {
 public:
  /// Waits for another run's, which takes milliseconds; throws Error(output) that says whose it is where that
  /// lasts longer than `wait_s`, or where the folder lets no file be made.
  explicit FolderLock(const std::filesystem::path& folder, double wait_s = 10);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();
  /// False where the file system has no locks: the folder is not locked, and nobody can know whose its files
  /// are.
  bool held() const { return held_; }

 private:
  bool take();
  std::string path_;
  int descriptor_ = -1;
  bool held_ = false;
};

/// Folders in which this process gave names without a lock, since their file systems have none.
std::vector<std::string> folders_without_locks();

}  // namespace libchar::detail

#pragma once
// The owner of an unfinished file: a process, on this machine or on another. In a folder on a network, or shared by
// two containers, a process number proves nothing about a process elsewhere.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace libchar::detail {

/// Between the name that a file will have and the place, process and number that make a temporary one of it.
inline constexpr std::string_view kTemporaryMark = ".libchar-tmp-";

/// Where process numbers mean what they mean to this process: 16 digits made of the host, its boot and the PID
/// namespace.
std::string place_of_process();

/// "PATH.libchar-tmp-PLACE-PROCESS-ATTEMPT"; a name too long for that is cut.
std::string temporary_name(const std::string& path, int attempt);

/// A process by its place and number.
struct FileOwner {
  std::string place;
  int process = 0;
  /// A process of this place that has ended.
  bool is_gone() const;
};

/// Nothing if the name is not that of a temporary file.
std::optional<FileOwner> owner_by_name(std::string_view file_name);

enum class Lock {
  taken,
  of_another,
  impossible  ///< this file system has no locks, or none of this descriptor
};

/// Locks the file for as long as this open file description lives. It must be open for writing. All machines that
/// share a network file system see the lock.
Lock lock_whole_file(int descriptor);

/// The same against writers only, for a file that is open for reading.
Lock share_whole_file(int descriptor);

/// Removes temporary files whose owner has ended. The folder must be locked and have no journal, which may still need
/// them.
void remove_litter(const std::string& folder);

// One writer at a time gives names in a folder: on this machine, in its containers, and on others that share
// the folder.

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
  /// False where the file system has no locks: the folder is not locked, and nobody can know whose its files are.
  bool held() const { return held_; }

 private:
  FolderLock(std::nullptr_t, std::string path) : path_(std::move(path)) {}
  bool take();
  std::string path_;
  int descriptor_ = -1;
  bool held_ = false;
};

/// Folders in which this process gave names without a lock, since their file systems have none.
std::vector<std::string> folders_without_locks();

}  // namespace libchar::detail

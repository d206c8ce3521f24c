
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "libchar/core/document/json.hpp"
#include "libchar/core/file/file_owner.hpp"
#include "libchar/core/file/unfinished_files.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar::detail {
namespace {

namespace fs = std::filesystem;

struct Unlocked {
  std::mutex mutex;
  std::vector<std::string> folders;
};

Unlocked& unlocked() {
  static Unlocked all;
  return all;
}

void remember_unlocked(const std::string& folder) {
  Unlocked& all = unlocked();
  const std::lock_guard guard(all.mutex);
  if (std::find(all.folders.begin(), all.folders.end(), folder) == all.folders.end()) all.folders.push_back(folder);
}

std::string this_host() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

/// Who writes here and since when, for whoever waits. That it cannot be written down stops nobody. A file that
/// is also something else (another name of it, more than we would write) is left as it is.
void sign(int file) {
  struct stat status {};
  if (::fstat(file, &status) != 0 || status.st_nlink != 1 || status.st_size > 1024) return;
  Json text = {{"process", ::getpid()}, {"host", this_host()}};
  // By the calendar of the library: that of C opens the file of the time zone.
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  const auto day = std::chrono::floor<std::chrono::days>(now);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss time(now - day);
  text["since"] = fmt::format("{}-{:02}-{:02} {:02}:{:02}:{:02} UTC", static_cast<int>(date.year()),
                              static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                              time.hours().count(), time.minutes().count(), time.seconds().count());
  const std::string line = text.dump(-1, ' ', true, Json::error_handler_t::replace) + "\n";
  if (::ftruncate(file, 0) != 0) return;
  [[maybe_unused]] const ssize_t said = ::pwrite(file, line.data(), line.size(), 0);
}

/// "process 12 of node7, since …", as the lock's owner says; "" where it has not yet.
std::string owner_of_lock(const std::string& path) {
  std::array<char, 1024> bytes{};
  const int file = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return "";
  const ssize_t size = ::read(file, bytes.data(), bytes.size());
  ::close(file);
  const Json text = Json::parse(bytes.data(), bytes.data() + std::max<ssize_t>(size, 0), nullptr, false);
  if (!text.is_object() || !text.contains("process") || !text["process"].is_number_integer() ||
      !text.contains("host") || !text["host"].is_string() || !text.contains("since") || !text["since"].is_string())
    return "";
  return fmt::format(" (process {} of {}, since {})", text["process"].get<std::int64_t>(),
                     printable(text["host"].get<std::string>()), printable(text["since"].get<std::string>()));
}

/// Who may write into the folder may lock it: the file has the folder's rights of writing.
void share_rights(int file, const std::string& folder) {
  struct stat rights {};
  if (::stat(folder.c_str(), &rights) == 0) [[maybe_unused]]
    const int shared = ::fchmod(file, 0444U | (rights.st_mode & 0222U));
}

/// The opened lock file, made where there is none; -1 and errno. Needs no memory: the file is the caller's to remove.
int opened_lock(const std::string& path, const std::string& folder, bool& for_writing) {
  constexpr int kFlags = O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC;
  for_writing = true;
  int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | kFlags, 0666);
  if (file >= 0) {
    share_rights(file, folder);
    return file;
  }
  if (errno != EEXIST) return -1;
  file = ::open(path.c_str(), O_RDWR | kFlags);
  if (file >= 0 || errno != EACCES) return file;
  for_writing = false;  // another user's, in a folder where each may change only what is his
  return ::open(path.c_str(), O_RDONLY | kFlags);
}

/// Who removes the file unlocks it for nobody: what has been locked must be what stands there. Throws
/// Error(output) where that cannot be known.
bool is_still(int& file, const std::string& path) {
  struct stat opened {
  }, named{};
  if (::fstat(file, &opened) != 0 || (::lstat(path.c_str(), &named) != 0 && errno != ENOENT)) {
    const int problem = errno;
    ::close(std::exchange(file, -1));
    throw output_error("E0501", path).says("cannot look at this lock: {}", std::strerror(problem));
  }
  return opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

}  // namespace

/// False where another has it, or where it has just been given up: to be tried again.
bool FolderLock::take() {
  bool for_writing = true;
  const std::string folder = fs::path(path_).parent_path().string();
  descriptor_ = opened_lock(path_, folder, for_writing);
  if (descriptor_ < 0) {
    if (errno == ENOENT) {  // given up between two looks, unless the folder is none
      if (std::error_code ignored; fs::is_directory(folder, ignored)) return false;
      errno = ENOENT;
    }
    throw output_error("E0501", path_).says("cannot create a file in this folder: {}", std::strerror(errno));
  }
  const Lock lock = for_writing ? lock_whole_file(descriptor_) : share_whole_file(descriptor_);
  if (lock == Lock::impossible) {
    remember_unlocked(folder);
    return true;
  }
  held_ = lock == Lock::taken && is_still(descriptor_, path_);
  if (!held_) {
    ::close(std::exchange(descriptor_, -1));
    return false;
  }
  remember_unfinished(path_);
  if (for_writing) sign(descriptor_);
  return true;
}

// By another constructor: behind its end what throws, memory that is refused included, gives the lock up.
FolderLock::FolderLock(const fs::path& folder, double wait_s)
    : FolderLock(nullptr, ((folder.empty() ? fs::path(".") : folder) / kLockFile).string()) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(wait_s);
  for (int pause_ms = 1;; pause_ms = std::min(2 * pause_ms, 16)) {
    const bool late = Clock::now() > end;
    if (take()) return;
    if (late) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms));
  }
  throw output_error("E0515", fs::path(path_).parent_path().string())
      .says("another run{} is writing its results into this folder", owner_of_lock(path_))
      .hint("wait for it or choose another folder");
}

FolderLock::~FolderLock() {
  if (descriptor_ < 0) return;
  ::unlink(path_.c_str());  // before it is unlocked: whoever waits finds that it is another one
  forget_unfinished(path_);
  ::close(descriptor_);
}

std::vector<std::string> folders_without_locks() {
  Unlocked& all = unlocked();
  const std::lock_guard guard(all.mutex);
  return all.folders;
}

}  // namespace libchar::detail

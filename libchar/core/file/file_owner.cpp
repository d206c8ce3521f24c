#include "libchar/core/file/file_owner.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <ctime>
#include <memory>

#include "libchar/core/file/sha256.hpp"

namespace libchar::detail {
namespace {

/// What a link or a small file of /proc says; "" where there is none.
std::string said_by(const char* path) {
  std::array<char, 256> text{};
  const ssize_t linked = ::readlink(path, text.data(), text.size());
  if (linked > 0) return {text.data(), static_cast<std::size_t>(linked)};
  const int file = ::open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return "";
  const ssize_t read = ::read(file, text.data(), text.size());
  ::close(file);
  return {text.data(), static_cast<std::size_t>(read > 0 ? read : 0)};
}

/// Temporary files of other places are litter a day after their last change, if nobody holds them: no owner
/// leaves one alone between opening and locking it for so long, clocks that differ included.
constexpr std::time_t kOldSeconds = 24 * 3600;

Lock lock_as(int descriptor, short type) {
  struct flock whole {};
  whole.l_type = type;
  whole.l_whence = SEEK_SET;
  // Locks of the open file, not of the process: NFS hands them to the server, and closing another descriptor
  // keeps them.
  if (::fcntl(descriptor, F_OFD_SETLK, &whole) == 0) return Lock::taken;
  if (errno == EAGAIN || errno == EACCES) return Lock::of_another;
  if (errno != EINVAL && errno != ENOSYS) return Lock::impossible;
  if (::flock(descriptor, (type == F_WRLCK ? LOCK_EX : LOCK_SH) | LOCK_NB) == 0) return Lock::taken;
  return errno == EWOULDBLOCK ? Lock::of_another : Lock::impossible;
}

/// Whether this temporary file has been left: nobody holds it, and its owner cannot be about to.
bool is_left(int file, const FileOwner& owner) {
  struct stat status {};
  if (::fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) return false;
  const bool old = std::time(nullptr) - status.st_mtime > kOldSeconds;
  return (old || owner.is_gone()) && lock_whole_file(file) == Lock::taken;
}

void remove_if_left(const std::string& path, const FileOwner& owner) {
  const int file = ::open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (file < 0) return;
  if (is_left(file, owner)) ::unlink(path.c_str());
  ::close(file);
}

}  // namespace

std::string place_of_process() {
  static const std::string place = [] {
    std::array<char, 256> host{};
    ::gethostname(host.data(), host.size() - 1);
    Sha256 hash;
    hash.update(std::string(host.data()) + "\n");
    hash.update(said_by("/proc/sys/kernel/random/boot_id"));
    hash.update(said_by("/proc/self/ns/pid"));
    return hash.finish().substr(0, 16);
  }();
  return place;
}

std::string temporary_name(const std::string& path, int attempt) {
  const std::string suffix = fmt::format("{}{}-{}-{}", kTemporaryMark, place_of_process(), ::getpid(), attempt);
  constexpr std::size_t kLongestName = 255;
  const std::size_t begin = path.rfind('/') + 1;  // 0 where there is none
  return path.substr(0, begin) + path.substr(begin, kLongestName - suffix.size()) + suffix;
}

bool FileOwner::is_gone() const { return place == place_of_process() && ::kill(process, 0) != 0 && errno == ESRCH; }

std::optional<FileOwner> owner_by_name(std::string_view file_name) {
  const std::size_t mark = file_name.rfind(kTemporaryMark);
  if (mark == std::string_view::npos) return std::nullopt;
  std::string_view rest = file_name.substr(mark + kTemporaryMark.size());
  FileOwner owner;
  // Files of earlier versions name no place, only process and number: theirs is unknown.
  const std::size_t parts = 1 + static_cast<std::size_t>(std::count(rest.begin(), rest.end(), '-'));
  if (parts == 3) {
    owner.place = rest.substr(0, rest.find('-'));
    rest.remove_prefix(owner.place.size() + 1);
  }
  const auto read = std::from_chars(rest.data(), rest.data() + rest.size(), owner.process);
  const std::string_view number(read.ptr, static_cast<std::size_t>(rest.end() - read.ptr));
  const bool known = read.ec == std::errc{} && owner.process > 0 && number.size() > 1 && number[0] == '-' &&
                     number.find_first_not_of("0123456789", 1) == std::string_view::npos &&
                     owner.place.find_first_not_of("0123456789abcdef") == std::string::npos;
  return known ? std::optional(owner) : std::nullopt;
}

Lock lock_whole_file(int descriptor) { return lock_as(descriptor, F_WRLCK); }

Lock share_whole_file(int descriptor) { return lock_as(descriptor, F_RDLCK); }

void remove_litter(const std::string& folder) {
  const std::unique_ptr<DIR, int (*)(DIR*)> entries(::opendir(folder.c_str()), ::closedir);
  if (!entries) return;
  while (const dirent* entry = ::readdir(entries.get()))
    if (const auto owner = owner_by_name(entry->d_name)) remove_if_left(folder + "/" + entry->d_name, *owner);
}

}  // namespace libchar::detail

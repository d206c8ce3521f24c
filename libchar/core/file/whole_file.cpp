#include "libchar/core/file/whole_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "libchar/core/detail/output_journal.hpp"
#include "libchar/core/file/file_owner.hpp"
#include "libchar/core/file/unfinished_files.hpp"
#include "libchar/core/refusal.hpp"

namespace libchar {
namespace {

constexpr std::size_t kBuffer = std::size_t{1} << 18;

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
}

bool exists(const std::string& path) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0;
}

// A device or pipe (/dev/null, /dev/full) cannot be replaced by renaming: it is written through.
bool is_special(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

std::string real_folder_of(const std::string& path) {
  char* const real = ::realpath(folder_of(path).c_str(), nullptr);
  std::string result = real == nullptr ? "" : real;
  std::free(real);
  return result;
}

// The open file of this process that a path means (/dev/stdout, /dev/fd/3, a link to one of them), or -1. Such a
// name is no place for another file: what was opened is written to, where it stands.
int own_descriptor(std::string path) {
  const std::string own = real_folder_of("/proc/self/fd/.");
  for (int links = 0; links < 40 && !own.empty(); ++links) {
    char target[4096];
    const ssize_t n = ::readlink(path.c_str(), target, sizeof target);
    if (n <= 0 || n == sizeof target) return -1;
    if (real_folder_of(path) == own) {
      const std::string number = path.substr(path.rfind('/') + 1);
      int descriptor = -1;
      const auto read = std::from_chars(number.data(), number.data() + number.size(), descriptor);
      return read.ec == std::errc{} && read.ptr == number.data() + number.size() ? descriptor : -1;
    }
    const std::string next(target, static_cast<std::size_t>(n));
    path = next.front() == '/' ? next : folder_of(path) + "/" + next;
  }
  return -1;
}

// What can be said of a name before anything is opened.
void refuse_name(const std::string& path, bool overwrite) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode))
    throw output_error("E0502", path).says("is a folder, a file was expected").hint("name a file inside it");
  if (::lstat(path.c_str(), &status) != 0) return;
  if (!overwrite)
    throw output_error("E0503", path)
        .says("exists already and is left as it is")
        .hint("choose another name or pass `overwrite`");
  // Renaming asks for the folder's rights alone; who made a file read-only meant the file. An administrator may
  // write everything, so the bits are looked at too.
  if (S_ISREG(status.st_mode) &&
      ((status.st_mode & 0222U) == 0 || ::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0))
    throw output_error("E0517", path)
        .says("is read-only and is left as it is")
        .hint("choose another name, or make it writable first");
}

// A new file in the place of an older one is as private as that was: owner, group and rights are kept, and where the
// group cannot be, it gets no rights.
void keep_rights(int descriptor, const std::string& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return;
  mode_t mode = status.st_mode & 0777U;
  if (::fchown(descriptor, status.st_uid, status.st_gid) != 0 &&
      ::fchown(descriptor, static_cast<uid_t>(-1), status.st_gid) != 0)
    mode &= ~mode_t{070};
  [[maybe_unused]] const int kept = ::fchmod(descriptor, mode);
}

}  // namespace

void WholeFile::fail(std::string_view doing) const {
  throw output_error("E0501", path_).says("cannot {}: {}", doing, std::strerror(errno));
}

WholeFile::WholeFile(std::string path, bool overwrite) : path_(std::move(path)), overwrite_(overwrite) {
  if (path_.empty()) throw output_error("E0502").says("an output file needs a name");
  if (open_through()) return;
  refuse_name(path_, overwrite_);
  // A file without a name vanishes with the process, however that ends; not every file system offers it, and it gets
  // its name by /proc, which a bare root may lack.
  if (::access("/proc/self/fd", X_OK) == 0)
    descriptor_ = ::open(folder_of(path_).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  for (int attempt = 0; descriptor_ < 0 && attempt < 100; ++attempt) {
    if (!temporary_.empty()) forget_unfinished(temporary_);
    temporary_ = detail::temporary_name(path_, attempt);
    remember_unfinished(temporary_);
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST) break;
  }
  if (descriptor_ < 0) {
    const int problem = errno;
    hand_over();
    errno = problem;
    fail("create a file in this folder");
  }
  detail::lock_whole_file(descriptor_);  // where that is impossible, nobody removes anything
  keep_rights(descriptor_, path_);
}

bool WholeFile::open_through() {
  const int own = own_descriptor(path_);
  special_ = own >= 0 || is_special(path_);
  if (!special_) return false;
  descriptor_ = own >= 0 ? ::fcntl(own, F_DUPFD_CLOEXEC, 3) : ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor_ < 0) fail("open for writing");
  const bool appends = (::fcntl(descriptor_, F_GETFL) & O_APPEND) != 0;
  begin_ = appends ? -1 : ::lseek(descriptor_, 0, SEEK_CUR);
  return true;
}

WholeFile::WholeFile(WholeFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_(std::exchange(other.temporary_, {})),
      buffer_(std::move(other.buffer_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      begin_(other.begin_),
      flushed_(other.flushed_),
      on_disk_(other.on_disk_),
      overwrite_(other.overwrite_),
      special_(other.special_) {}

WholeFile::~WholeFile() {
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) forget_unfinished(temporary_);
}

void WholeFile::hand_over() {
  forget_unfinished(temporary_);
  temporary_.clear();
}

void WholeFile::write(std::string_view bytes) {
  on_disk_ = false;
  while (!bytes.empty()) {  // in pieces: the buffer stays with the file
    const std::string_view piece = bytes.substr(0, kBuffer);
    buffer_.append(piece);
    if (buffer_.size() >= kBuffer) flush();
    bytes.remove_prefix(piece.size());
  }
}

void WholeFile::flush() {
  for (std::size_t done = 0; done < buffer_.size();) {
    const ssize_t n = ::write(descriptor_, buffer_.data() + done, buffer_.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("write");
    done += static_cast<std::size_t>(n);
  }
  flushed_ = flushed_ || !buffer_.empty();
  buffer_.clear();
}

void WholeFile::rewrite(std::size_t offset, std::string_view bytes) {
  on_disk_ = false;
  if (!flushed_) {
    buffer_.replace(offset, bytes.size(), bytes);
    return;
  }
  if (begin_ < 0)
    throw output_error("E0501", path_)
        .says("this format says at its beginning how long it is, and a pipe cannot be gone back in")
        .hint("write to a file, or as CSV");
  flush();
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n =
        ::pwrite(descriptor_, bytes.data() + done, bytes.size() - done, begin_ + static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("write");
    done += static_cast<std::size_t>(n);
  }
}

void WholeFile::flush_to_disk() {
  if (on_disk_ || descriptor_ < 0) return;
  flush();
  if (!special_ && ::fsync(descriptor_) != 0) fail("flush to disk");
  on_disk_ = true;
}

// False where the name is taken.
bool WholeFile::link_to(const std::string& name) const {
  const std::string source = fmt::format("/proc/self/fd/{}", descriptor_);
  if (::linkat(AT_FDCWD, source.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0) return true;
  if (errno != EEXIST) fail("name the finished file");
  return false;
}

void WholeFile::prepare() {
  if (descriptor_ < 0) return;
  flush_to_disk();
  if (special_) return;
  // A nameless file gets a temporary name first: linkat cannot replace.
  for (int attempt = 0; temporary_.empty(); ++attempt) {
    std::string name = detail::temporary_name(path_, attempt);
    remember_unfinished(name);
    if (link_to(name)) {
      temporary_ = std::move(name);  // a copy might find no memory, and the file would stay
      break;
    }
    forget_unfinished(name);
    if (attempt == 100) {
      errno = EEXIST;
      fail("name the finished file");
    }
  }
  refuse_taken();
}

// What has come to stand under the name since the file was opened.
void WholeFile::refuse_taken() const {
  struct stat status {};
  if (special_) return;
  if (::stat(path_.c_str(), &status) == 0 && S_ISDIR(status.st_mode)) {
    errno = EISDIR;
    fail("take its name");
  }
  if (!overwrite_ && exists(path_)) refuse_name(path_, false);
}

// Where nothing has the name a nameless file gets it at once, and no kill can leave it under a temporary one.
bool WholeFile::take_free_name() {
  if (!temporary_.empty() || exists(path_)) return false;
  const GivingNames naming;
  return link_to(path_);
}

void WholeFile::close_device() {
  flush_to_disk();
  if (descriptor_ >= 0 && ::close(std::exchange(descriptor_, -1)) != 0) fail("write");
}

void WholeFile::commit() {
  if (special_) return close_device();
  flush_to_disk();
  {
    const std::string folder = folder_of(path_);
    const detail::FolderLock lock(folder);
    finish_journal(folder);
    if (lock.held() && exists(path_)) detail::remove_litter(folder);
    commit_in_locked_folder();
  }
  sync_folder(folder_of(path_));
}

void WholeFile::commit_in_locked_folder() {
  if (special_) return close_device();
  flush_to_disk();
  if (!take_free_name()) {
    prepare();
    const GivingNames naming;
    if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail("rename into place");
    hand_over();
  }
  // Only now: until it has its name the lock says whose it is. What closing could report, fsync has.
  ::close(std::exchange(descriptor_, -1));
}

bool writes_through(const std::string& path) { return own_descriptor(path) >= 0 || is_special(path); }

void check_output(const std::string& path, bool overwrite) {
  // A device or pipe is not even opened: who reads it would take that for the whole of it.
  if (writes_through(path)) return;
  const WholeFile trial(path, overwrite);  // discarded: nothing appears under the name
}

void sync_folder(const std::string& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

void write_whole_file(const std::string& path, std::string_view bytes, bool overwrite) {
  WholeFile file(path, overwrite);
  file.write(bytes);
  file.commit();
}

}  // namespace libchar

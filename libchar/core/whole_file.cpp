#include "libchar/core/whole_file.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include "libchar/core/error.hpp"
#include "libchar/core/unfinished_files.hpp"

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

std::string temporary_name(const std::string& path, int attempt) {
  return fmt::format("{}{}{}-{}", path, kTemporaryMark, ::getpid(), attempt);
}

// A device or pipe (/dev/stdout, /dev/full) cannot be replaced by renaming: it is written through.
bool is_special(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

}  // namespace

void WholeFile::fail(std::string_view doing) const {
  throw Error({ErrorKind::output,
               "E0501",
               path_,
               fmt::format("cannot {}: {}", doing, std::strerror(errno)),
               "",
               ""});
}

WholeFile::WholeFile(std::string path, bool overwrite)
    : path_(std::move(path)), overwrite_(overwrite) {
  if (path_.empty())
    throw Error({ErrorKind::output, "E0502", "", "an output file needs a name", "", ""});
  special_ = is_special(path_);
  if (special_) {
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail("open for writing");
    return;
  }
  struct stat status {};
  if (::stat(path_.c_str(), &status) == 0 && S_ISDIR(status.st_mode))
    throw Error({ErrorKind::output,
                 "E0502",
                 path_,
                 "is a folder, a file was expected",
                 "",
                 "name a file inside it"});
  if (!overwrite_ && exists(path_))
    throw Error({ErrorKind::output,
                 "E0503",
                 path_,
                 "exists already and is left as it is",
                 "",
                 "choose another name or pass `overwrite`"});
  // A file without a name vanishes with the process, however that ends; not every file system offers it.
  descriptor_ = ::open(folder_of(path_).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  for (int attempt = 0; descriptor_ < 0 && attempt < 100; ++attempt) {
    if (!temporary_.empty()) forget_unfinished(temporary_);
    temporary_ = temporary_name(path_, attempt);
    remember_unfinished(temporary_);
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST) break;
  }
  if (descriptor_ >= 0) return;
  const int problem = errno;
  hand_over();
  errno = problem;
  fail("create a file in this folder");
}

WholeFile::WholeFile(WholeFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_(std::exchange(other.temporary_, {})),
      buffer_(std::move(other.buffer_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      overwrite_(other.overwrite_),
      special_(other.special_) {}

WholeFile::~WholeFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (temporary_.empty()) return;
  ::unlink(temporary_.c_str());
  forget_unfinished(temporary_);
}

void WholeFile::hand_over() {
  forget_unfinished(temporary_);
  temporary_.clear();
}

void WholeFile::write(std::string_view bytes) {
  buffer_.append(bytes);
  if (buffer_.size() >= kBuffer) flush();
}

void WholeFile::flush() {
  for (std::size_t done = 0; done < buffer_.size();) {
    const ssize_t n = ::write(descriptor_, buffer_.data() + done, buffer_.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("write");
    done += static_cast<std::size_t>(n);
  }
  buffer_.clear();
}

void WholeFile::rewrite(std::size_t offset, std::string_view bytes) {
  flush();
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::pwrite(
        descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("write");
    done += static_cast<std::size_t>(n);
  }
}

void WholeFile::flush_to_disk() {
  flush();
  if (!special_ && ::fsync(descriptor_) != 0) fail("flush to disk");
}

// False where the name is taken.
bool WholeFile::link_to(const std::string& name) const {
  const std::string source = fmt::format("/proc/self/fd/{}", descriptor_);
  if (::linkat(AT_FDCWD, source.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0)
    return true;
  if (errno != EEXIST) fail("name the finished file");
  return false;
}

void WholeFile::prepare() {
  if (descriptor_ < 0) return;
  flush_to_disk();
  if (special_) return;
  // A nameless file gets a temporary name first: linkat cannot replace.
  for (int attempt = 0; temporary_.empty(); ++attempt) {
    const std::string name = temporary_name(path_, attempt);
    remember_unfinished(name);
    if (link_to(name)) {
      temporary_ = name;
      break;
    }
    forget_unfinished(name);
    if (attempt == 100) {
      errno = EEXIST;
      fail("name the finished file");
    }
  }
  if (::close(std::exchange(descriptor_, -1)) != 0) fail("close");
  struct stat status {};
  if (::stat(path_.c_str(), &status) == 0 && S_ISDIR(status.st_mode)) {
    errno = EISDIR;
    fail("take its name");
  }
  if (!overwrite_ && exists(path_)) {
    errno = EEXIST;
    fail("take its name");
  }
}

// Where nothing has the name a nameless file gets it at once, and no kill can leave it under a temporary one.
bool WholeFile::take_free_name() {
  if (special_ || descriptor_ < 0 || !temporary_.empty()) return false;
  flush_to_disk();
  const GivingNames naming;
  if (exists(path_) || !link_to(path_)) return false;
  if (::close(std::exchange(descriptor_, -1)) != 0) {
    ::unlink(path_.c_str());
    fail("close");
  }
  sync_folder(folder_of(path_));
  return true;
}

void WholeFile::commit() {
  if (take_free_name()) return;
  prepare();
  if (descriptor_ >= 0) {  // a device or pipe
    if (::close(std::exchange(descriptor_, -1)) != 0) fail("write");
    return;
  }
  {
    const GivingNames naming;
    if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail("rename into place");
    hand_over();
  }
  remove_litter(folder_of(path_));
  sync_folder(folder_of(path_));
}

void remove_litter(const std::string& folder) {
  const std::unique_ptr<DIR, int (*)(DIR*)> entries(::opendir(folder.c_str()), ::closedir);
  if (!entries) return;
  while (const dirent* entry = ::readdir(entries.get())) {
    const std::string name = entry->d_name;
    const std::size_t mark = name.rfind(kTemporaryMark);
    if (mark == std::string::npos) continue;
    const std::string number = name.substr(mark + kTemporaryMark.size());
    pid_t process = 0;
    const auto read = std::from_chars(number.data(), number.data() + number.size(), process);
    if (read.ec != std::errc{} || *read.ptr != '-' || process <= 0 ||
        number.find_first_not_of("-0123456789") != std::string::npos)
      continue;
    // Of a folder of such a name it is none.
    if (::kill(process, 0) != 0 && errno == ESRCH) ::unlink((folder + "/" + name).c_str());
  }
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

void refuse_same_file(const std::string& input, const std::string& output) {
  struct stat a {
  }, b{};
  if (::stat(input.c_str(), &a) != 0 || ::stat(output.c_str(), &b) != 0) return;
  if (a.st_dev == b.st_dev && a.st_ino == b.st_ino && S_ISREG(a.st_mode))
    throw Error({ErrorKind::output,
                 "E0504",
                 output,
                 "is the input itself; an input is never overwritten",
                 "",
                 "choose another name"});
}

}  // namespace libchar

#include "libchar/log/binary/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "libchar/core/error.hpp"

namespace libchar {

BinaryFile::BinaryFile(std::string path) : path_(std::move(path)) {
  const auto fail = [&](const char* code, std::string what, std::string hint) {
    throw Error({ErrorKind::input, code, path_, std::move(what), "", std::move(hint)});
  };
  struct stat status {};
  // Looked at before it is opened: opening a pipe would wait for its writer.
  if (::stat(path_.c_str(), &status) != 0)
    fail("E0101", fmt::format("cannot be opened: {}", std::strerror(errno)), "");
  if (S_ISDIR(status.st_mode)) fail("E0101", "is a folder, not a log", "");
  if (!S_ISREG(status.st_mode))
    fail("E0103", "is not a regular file; binary formats need one", "copy it to a file first");
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY);
  if (descriptor_ < 0) fail("E0101", fmt::format("cannot be opened: {}", std::strerror(errno)), "");
  size_ = static_cast<std::uint64_t>(status.st_size);
  ::posix_fadvise(descriptor_, 0, 0, POSIX_FADV_SEQUENTIAL);
}

BinaryFile::~BinaryFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void BinaryFile::read(std::uint64_t offset, std::span<std::byte> to) const {
  for (std::size_t done = 0; done < to.size();) {
    const ssize_t n =
        ::pread(descriptor_, to.data() + done, to.size() - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0)
      throw Error({ErrorKind::input,
                   "E0101",
                   fmt::format("{} (byte {})", path_, offset + done),
                   fmt::format("cannot be read: {}", std::strerror(errno)),
                   "",
                   ""});
    if (n == 0)
      throw Error({ErrorKind::input,
                   "E0104",
                   fmt::format("{} (byte {})", path_, offset + done),
                   "became shorter while it was read",
                   "",
                   "read a copy that nobody writes to"});
    done += static_cast<std::size_t>(n);
  }
}

std::string BinaryFile::head(std::size_t count) const {
  std::string bytes(static_cast<std::size_t>(std::min<std::uint64_t>(count, size_)), '\0');
  read(0, std::as_writable_bytes(std::span(bytes)));
  return bytes;
}

}  // namespace libchar

#include "libchar/core/document/document_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "libchar/core/document/document.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/file/file_text.hpp"

namespace libchar {
namespace {

[[noreturn]] void cannot_read(const std::string& path,
                              const std::string& why,
                              const std::string& hint = "") {
  throw Error({ErrorKind::input, "E0551", path, why, "", hint});
}

}  // namespace

std::string read_document_text(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) {
    const int reason = errno;
    cannot_read(path, std::string("cannot be read: ") + std::strerror(reason));
  }
  struct Closer {
    int descriptor;
    ~Closer() { ::close(descriptor); }
  } closer{descriptor};
  struct stat status {};
  if (::fstat(descriptor, &status) != 0)
    cannot_read(path, std::string("cannot be read: ") + std::strerror(errno));
  if (S_ISDIR(status.st_mode)) cannot_read(path, "is a folder, a file was expected");
  if (!S_ISREG(status.st_mode)) cannot_read(path, "is no regular file");
  if (static_cast<std::size_t>(status.st_size) > kMaxDocumentBytes)
    cannot_read(path,
                fmt::format("{} bytes exceed the limit of {}", status.st_size, kMaxDocumentBytes),
                "is this a log? a model or scene file is a short text");
  return rest_of_file(descriptor, path, kMaxDocumentBytes);
}

}  // namespace libchar

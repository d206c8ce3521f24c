#include "libchar/core/file/file_text.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "libchar/core/refusal.hpp"

namespace libchar {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 16U;

[[noreturn]] void fail_to(const char* be, const std::string& path) {
  throw input_error("E0101", path).says("cannot be {}: {}", be, std::strerror(errno));
}

struct OpenFile {
  explicit OpenFile(const std::string& path) : descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (descriptor < 0) fail_to("opened", path);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() { ::close(descriptor); }
  int descriptor;
};

}  // namespace

std::string rest_of_file(int descriptor, const std::string& path, std::size_t most) {
  std::string text;
  for (;;) {
    const std::size_t done = text.size();
    text.resize(std::min(most, std::max(2 * done, done + kPiece)));
    const ssize_t got = ::read(descriptor, text.data() + done, text.size() - done);
    const int error = errno;
    text.resize(done + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got == 0) return text;
    if (got > 0 || error == EINTR) continue;
    errno = error;
    fail_to("read", path);
  }
}

void for_pieces_of_file(const std::string& path, std::size_t piece_bytes,
                        const std::function<void(std::string_view)>& take) {
  const OpenFile file(path);
  for (;;) {
    const std::string piece = rest_of_file(file.descriptor, path, piece_bytes);
    if (piece.empty()) return;
    take(piece);
  }
}

std::string file_text(const std::string& path, std::size_t most) {
  return rest_of_file(OpenFile(path).descriptor, path, most);
}

}  // namespace libchar

#include "libchar/log/binary/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "libchar/core/file/known_digest.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/core/parallel/beside.hpp"
#include "libchar/core/refusal.hpp"

namespace libchar {

std::string wrong_start(std::string_view found, std::string_view mark, std::string_view what) {
  if (found.empty()) return fmt::format("is empty, {} was expected", what);
  if (found.size() < mark.size() && mark.starts_with(found))
    return fmt::format("ends at byte {}, inside the {} bytes that mark {}: no whole message or array is there",
                       found.size(), mark.size(), what);
  return fmt::format("does not begin like {}", what);
}

FileHash::~FileHash() {
  stop_ = true;
  if (hashing_.valid()) hashing_.wait();
}

void FileHash::start() {
  if (!wanted_ || hashing_.valid() || !digest_.empty()) return;
  if (files_.size() == 1) digest_ = detail::known_digest(files_[0]->path());
  if (!digest_.empty()) return;
  hashing_ = parallel::beside([this] { return digest_of_files(); });
}

std::string FileHash::finish() {
  start();
  if (hashing_.valid()) digest_ = hashing_.get();
  return digest_;
}

std::string FileHash::digest_of_files() const {
  Sha256 sha;
  std::vector<std::byte> piece(std::size_t{1} << 20U);
  for (const BinaryFile* file : files_)
    for (std::uint64_t at = 0; at < file->size() && !stop_;) {
      const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(piece.size(), file->size() - at));
      file->read(at, std::span(piece).first(n));
      sha.update({reinterpret_cast<const char*>(piece.data()), n});
      at += n;
    }
  return sha.finish();
}

const std::byte* FileWindow::load(std::uint64_t byte, std::size_t count) {
  if (byte > file_->size() || count > file_->size() - byte) return nullptr;
  const std::uint64_t front = std::min<std::uint64_t>(byte, kept_);
  const std::uint64_t wanted = std::min<std::uint64_t>(file_->size() - byte, std::max(block_, count));
  // Emptied first: after a failed read no bytes stand here that are not the file's.
  bytes_.clear();
  std::vector<std::byte> fresh(static_cast<std::size_t>(front + wanted));
  file_->read(byte - front, fresh);
  bytes_.swap(fresh);
  first_ = byte - front;
  return bytes_.data() + front;
}

BinaryFile::BinaryFile(std::string path) : path_(std::move(path)) {
  struct stat status {};
  // Looked at before it is opened: opening a pipe would wait for its writer.
  if (::stat(path_.c_str(), &status) != 0)
    throw input_error("E0101", path_).says("cannot be opened: {}", std::strerror(errno));
  if (S_ISDIR(status.st_mode)) throw input_error("E0101", path_).says("is a folder, not a log");
  if (!S_ISREG(status.st_mode))
    throw input_error("E0103", path_)
        .says("is not a regular file; binary formats need one")
        .hint("copy it to a file first");
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY);
  if (descriptor_ < 0) throw input_error("E0101", path_).says("cannot be opened: {}", std::strerror(errno));
  size_ = static_cast<std::uint64_t>(status.st_size);
  ::posix_fadvise(descriptor_, 0, 0, POSIX_FADV_SEQUENTIAL);
}

BinaryFile::~BinaryFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void BinaryFile::read(std::uint64_t offset, std::span<std::byte> to) const {
  for (std::size_t done = 0; done < to.size();) {
    const ssize_t n = ::pread(descriptor_, to.data() + done, to.size() - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0)
      throw input_error("E0101", fmt::format("{} (byte {})", path_, offset + done))
          .says("cannot be read: {}", std::strerror(errno));
    if (n == 0)
      throw input_error("E0104", fmt::format("{} (byte {})", path_, offset + done))
          .says("became shorter while it was read")
          .hint("read a copy that nobody writes to");
    done += static_cast<std::size_t>(n);
  }
}

std::string BinaryFile::head(std::size_t count) const {
  std::string bytes(static_cast<std::size_t>(std::min<std::uint64_t>(count, size_)), '\0');
  read(0, std::as_writable_bytes(std::span(bytes)));
  return bytes;
}

}  // namespace libchar

#include "libchar/log/binary/window.hpp"

#include <algorithm>

namespace libchar {

const std::byte* FileWindow::load(std::uint64_t byte, std::size_t count) {
  if (byte > file_->size() || count > file_->size() - byte) return nullptr;
  const std::uint64_t front = std::min<std::uint64_t>(byte, kept_);
  const std::uint64_t wanted =
      std::min<std::uint64_t>(file_->size() - byte, std::max(block_, count));
  // Emptied first: after a failed read no bytes stand here that are not the file's.
  bytes_.clear();
  std::vector<std::byte> fresh(static_cast<std::size_t>(front + wanted));
  file_->read(byte - front, fresh);
  bytes_.swap(fresh);
  first_ = byte - front;
  return bytes_.data() + front;
}

}  // namespace libchar

#include "libchar/log/ros/file_window.hpp"

#include <algorithm>

namespace libchar {

std::span<const std::byte> MovingWindow::view(std::uint64_t at, std::size_t count) {
  if (at < begin_ || at + count > begin_ + filled_) {
    // What stands behind a large piece is looked at next, as a rule.
    const auto wanted =
        static_cast<std::size_t>(std::min<std::uint64_t>(std::max(count + kWindow / 16, kWindow), left(at)));
    filled_ = 0;  // nothing, should the reading fail
    if (buffer_.size() < wanted || buffer_.size() > 4 * std::max(wanted, kWindow)) {
      buffer_.resize(wanted);
      buffer_.shrink_to_fit();
    }
    file_.read(at, std::span(buffer_).first(wanted));
    begin_ = at;
    filled_ = wanted;
  }
  return std::span<const std::byte>(buffer_).subspan(static_cast<std::size_t>(at - begin_), count);
}

}  // namespace libchar

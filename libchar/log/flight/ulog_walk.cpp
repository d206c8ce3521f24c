// A message is u16 size, u8 type and `size` bytes; nothing marks its begin. It counts when its content agrees with its
// type and another one begins behind it, or the end: of one that lost bytes on its way the rest would be wrong numbers.
// From where that is not so the next such message is looked for byte by byte, and what lies between is counted.

#include "libchar/log/flight/ulog_walk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace libchar {
namespace {

constexpr std::string_view kTypes = "BFIMPQARDLCSO";
constexpr int kMostStrangers = 4;  // messages in a row that nothing is known of
constexpr std::size_t kUlogLookedBack = (kMostStrangers + 1) * 65538;
constexpr std::size_t kTextLookedAt = 48;  // bytes of a text whose characters are checked
constexpr std::array<unsigned char, 8> kSync = {0x2f, 0x73, 0x13, 0x20, 0x25, 0x0c, 0xbb, 0x12};

// What a type has in front of its text, and the least that it can measure.
struct TypeShape {
  std::uint32_t front = 0, least = 0;
  int key_length_at = -1;  // where the length of a key stands, the key behind it
};

TypeShape shape_of(char type) {
  switch (type) {
    case 'F':
      return {0, 3, -1};
    case 'I':
    case 'P':
      return {1, 2, 0};
    case 'M':
    case 'Q':
      return {2, 3, 1};
    case 'A':
      return {3, 4, -1};
    case 'L':
      return {9, 9, -1};
    case 'C':
      return {11, 11, -1};
    default:
      return {};
  }
}

bool is_text(const std::byte* bytes, std::size_t count) {
  return std::all_of(bytes, bytes + count, [](std::byte b) {
    const auto c = std::to_integer<unsigned>(b);
    return c >= 0x20 || c == '\n' || c == '\t' || c == '\r' || c == 0x1b;
  });
}

std::string at_byte(std::uint64_t byte) { return fmt::format("byte {}", byte); }

}  // namespace

UlogWalk::UlogWalk(const BinaryFile& file, std::size_t block_bytes, std::vector<UlogStretch> stretches,
                   const std::vector<UlogSizes>& sizes, Findings& losses)
    : window_(file, block_bytes, kUlogLookedBack), stretches_(std::move(stretches)), sizes_(&sizes), losses_(&losses) {
  position_ = stretches_.front().first;
  end_ = stretches_.front().end;
}

void UlogWalk::go_to(std::uint64_t byte) {
  for (std::size_t i = 0; i < stretches_.size(); ++i)
    if (byte >= stretches_[i].first && byte < stretches_[i].end) stretch_ = i;
  position_ = byte;
  end_ = stretches_[stretch_].end;
  known_good_ = 0;
}

void UlogWalk::skip_to_stretch() {
  while (position_ >= end_ && stretch_ + 1 < stretches_.size()) {
    ++stretch_;
    position_ = stretches_[stretch_].first;
    end_ = stretches_[stretch_].end;
  }
}

bool UlogWalk::next(UlogMessage& message) {
  for (;;) {
    skip_to_stretch();
    if (position_ >= end_) return false;
    if ((position_ == known_good_ || good(position_)) && believed(position_)) break;
    pass_over_damage();
  }
  const auto size = static_cast<std::size_t>(behind(position_) - position_);
  const std::byte* whole = window_.at(position_, size);
  message.byte = position_;
  message.type = static_cast<char>(whole[2]);
  message.body = {whole + 3, size - 3};
  position_ += size;
  return true;
}

// A good message that what follows does not contradict. What follows a text may be announced by it.
bool UlogWalk::believed(std::uint64_t byte) {
  known_good_ = 0;
  if (static_cast<char>(window_.at(byte, 3)[2]) != 'D') return true;
  const std::uint64_t next = behind(byte);
  if (next == end_ || cut_by_end(next)) return true;
  if (!good(next)) return false;
  known_good_ = next;
  return true;
}

// Is the message at this byte whole, and does it look like one?
UlogWalk::Sight UlogWalk::look(std::uint64_t byte) {
  if (end_ - byte < 3) return Sight::no;
  const std::byte* head = window_.at(byte, 3);
  const auto size = static_cast<std::uint32_t>(little_endian<2>(head));
  const char type = static_cast<char>(head[2]);
  if (size == 0 || size > end_ - byte - 3) return Sight::no;
  if (type == 'D') return look_at_data(byte, size);
  if (type == 'O' || type == 'R') return size == 2 ? Sight::sure : Sight::no;
  if (type == 'B') return byte == kUlogHeader && size >= 40 ? Sight::sure : Sight::no;
  if (type == 'S') {
    if (size != kSync.size()) return Sight::no;
    const std::byte* magic = window_.at(byte, 3 + kSync.size()) + 3;
    const bool right = std::equal(kSync.begin(), kSync.end(), magic,
                                  [](unsigned char a, std::byte b) { return a == std::to_integer<unsigned char>(b); });
    return right ? Sight::sure : Sight::no;
  }
  if (kTypes.find(type) != std::string_view::npos) return look_at_text(byte, size, type);
  // A type of a later version of the format.
  return (type >= 'A' && type <= 'Z') || (type >= 'a' && type <= 'z') ? Sight::maybe : Sight::no;
}

UlogWalk::Sight UlogWalk::look_at_data(std::uint64_t byte, std::uint32_t size) {
  if (size < 3) return Sight::no;
  const auto id = static_cast<std::size_t>(little_endian<2>(window_.at(byte, 5) + 3));
  if (id >= sizes_->size() || !(*sizes_)[id].known) return Sight::maybe;
  const UlogSizes& sizes = (*sizes_)[id];
  return size - 2 >= sizes.least && size - 2 <= sizes.most ? Sight::sure : Sight::maybe;
}

UlogWalk::Sight UlogWalk::look_at_text(std::uint64_t byte, std::uint32_t size, char type) {
  const TypeShape shape = shape_of(type);
  if (size < shape.least) return Sight::no;
  std::size_t text = size - shape.front;
  const std::size_t shown = std::min<std::size_t>(size, shape.front + kTextLookedAt);
  const std::byte* body = window_.at(byte, 3 + shown) + 3;
  if (shape.key_length_at >= 0) {
    const auto key = std::to_integer<std::size_t>(body[shape.key_length_at]);
    if (key == 0 || key > text) return Sight::no;
    text = key;
  }
  return is_text(body + shape.front, std::min(text, shown - shape.front)) ? Sight::sure : Sight::no;
}

// Is this the beginning of a message that the end of its stretch cuts?
bool UlogWalk::cut_by_end(std::uint64_t byte) {
  if (end_ - byte < 3) return true;
  const std::byte* head = window_.at(byte, 3);
  return little_endian<2>(head) > end_ - byte - 3 && kTypes.find(static_cast<char>(head[2])) != std::string_view::npos;
}

// Looks like a message, or like one of a kind that is not known, with a known one behind it or soon behind it.
bool UlogWalk::good(std::uint64_t byte) {
  for (int i = 0; i < kMostStrangers; ++i) {
    const Sight sight = look(byte);
    if (sight != Sight::maybe) return sight == Sight::sure;
    byte = behind(byte);
    if (byte == end_ || cut_by_end(byte)) return true;
  }
  return false;
}

std::uint64_t UlogWalk::next_good(std::uint64_t byte) {
  for (; end_ - byte >= 3; ++byte) {
    if (look(byte) != Sight::sure) continue;
    const std::uint64_t next = behind(byte);
    if (next == end_ || cut_by_end(next) || good(next)) return byte;
    if (static_cast<char>(window_.at(byte, 3)[2]) == 'A' && look(next) != Sight::no) return byte;
  }
  return end_;
}

void UlogWalk::pass_over_damage() {
  const std::uint64_t from = position_;
  position_ = next_good(from + 1);
  const bool cut = position_ == end_ && cut_by_end(from);
  if (cut)
    losses_->add("cut_message",
                 fmt::format("the log ends inside a message: its last {} bytes were left out", end_ - from),
                 at_byte(from));
  else
    losses_->add("damaged_bytes", "bytes that are not a message were left out, and messages among them are lost",
                 at_byte(from), position_ - from);
}

}  // namespace libchar

// A message is 0xa3 0x95, its type, and as many bytes as its FMT says. It counts when another one
// begins behind it, or the end: of one that lost bytes on its way the rest would be wrong numbers.
// From where that is not so the next such message is looked for byte by byte, and what lies between
// is counted.

#include "libchar/log/flight/dataflash_walk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace libchar {
namespace {

constexpr std::byte kFirstMagic{0xa3}, kSecondMagic{0x95};
constexpr std::size_t kDataflashLookedBack = 512;  // a longest message and the front of the next

}  // namespace

std::uint64_t dataflash_fill(const BinaryFile& file) {
  constexpr std::size_t kStep = 65536;
  std::array<std::byte, kStep> bytes;
  std::uint64_t begin = file.size();
  std::byte fill{0};
  while (begin > 0) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(begin, kStep));
    file.read(begin - count, std::span(bytes).first(count));
    if (begin == file.size()) fill = bytes[count - 1];
    if (fill != std::byte{0} && fill != std::byte{0xff}) return begin;
    std::size_t kept = count;
    while (kept > 0 && bytes[kept - 1] == fill) --kept;
    begin -= count - kept;
    if (kept > 0) return begin;
  }
  return begin;
}

DataflashWalk::DataflashWalk(const BinaryFile& file,
                             std::size_t block_bytes,
                             const DataflashFormats& formats,
                             Warnings& losses)
    : window_(file, block_bytes, kDataflashLookedBack),
      end_(file.size()),
      fill_(dataflash_fill(file)),
      formats_(&formats),
      losses_(&losses) {}

// Do the two magic bytes stand here, with a type behind them?
bool DataflashWalk::is_front(std::uint64_t byte) {
  if (end_ - byte < kDataflashFront) return false;
  const std::byte* front = window_.at(byte, kDataflashFront);
  return front[0] == kFirstMagic && front[1] == kSecondMagic;
}

// Bytes of the message here, 0 when none begins here, its type is not known or the end cuts it.
std::size_t DataflashWalk::whole_length(std::uint64_t byte) {
  if (!is_front(byte)) return 0;
  const std::size_t length =
      formats_->length(std::to_integer<std::uint8_t>(window_.at(byte, kDataflashFront)[2]));
  return length <= end_ - byte ? length : 0;
}

bool DataflashWalk::cut_by_end(std::uint64_t byte) {
  if (end_ - byte >= kDataflashFront)
    return is_front(byte) &&
           formats_->length(std::to_integer<std::uint8_t>(window_.at(byte, kDataflashFront)[2])) >
               end_ - byte;
  const std::byte* rest = window_.at(byte, static_cast<std::size_t>(end_ - byte));
  return end_ == byte || (rest[0] == kFirstMagic && (end_ - byte == 1 || rest[1] == kSecondMagic));
}

bool DataflashWalk::well_followed(std::uint64_t byte) {
  return byte == end_ || byte >= fill_ || is_front(byte) || cut_by_end(byte);
}

bool DataflashWalk::next(DataflashMessage& message) {
  std::size_t length = 0;
  while (position_ < end_) {
    length = whole_length(position_);
    if (length > 0 && well_followed(position_ + length)) break;
    pass_over_damage();
  }
  if (position_ >= end_) return false;
  const std::byte* whole = window_.at(position_, length);
  message.byte = position_;
  message.type = std::to_integer<std::uint8_t>(whole[2]);
  message.body = {whole + kDataflashFront, length - kDataflashFront};
  position_ += length;
  return true;
}

std::uint64_t DataflashWalk::next_good(std::uint64_t byte) {
  for (; end_ - byte >= kDataflashFront; ++byte) {
    const std::size_t length = whole_length(byte);
    if (length > 0 && well_followed(byte + length)) return byte;
  }
  return end_;
}

void DataflashWalk::pass_over_damage() {
  const std::uint64_t from = position_;
  if (from >= fill_) {
    position_ = end_;
    return;
  }
  position_ = next_good(from + 1);
  const std::string place = fmt::format("byte {}", from);
  const std::uint64_t bytes = std::min(position_, std::max(fill_, from + 1)) - from;
  if (position_ == end_ && cut_by_end(from))
    losses_->add(
        "cut_message",
        fmt::format("the log ends inside a message: its last {} bytes were left out", end_ - from),
        place);
  else if (is_front(from) && whole_length(from) == 0)
    losses_->add(
        "unknown_message", "messages of types that the log does not define were left out", place);
  else
    losses_->add("damaged_bytes",
                 "bytes that are no message were left out, and messages among them are lost",
                 place,
                 bytes);
}

}  // namespace libchar

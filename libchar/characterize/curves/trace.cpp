#include "libchar/characterize/curves/trace.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>

#include "libchar/core/numeric/lanes.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostBlocks = 800;

}  // namespace

// Comparisons with NaN are false: missing samples change no extreme. A comparison that holds is minus one.
LIBCHAR_WIDE_LANES void TraceMeter::Block::take(const double* samples, std::size_t count) {
  Four lows = Four{} + low, highs = Four{} + high;
  auto absent = lows != lows;
  const std::size_t whole = count - count % 4;
  for (std::size_t i = 0; i < whole; i += 4) {
    const Four x = LIBCHAR_FOUR(samples + i);
    lows = x < lows ? x : lows;
    highs = x > highs ? x : highs;
    absent += x != x;
  }
  for (int lane = 0; lane < 4; ++lane) {
    low = std::min(low, lows[lane]);
    high = std::max(high, highs[lane]);
    missing -= static_cast<std::uint64_t>(absent[lane]);
  }
  for (std::size_t i = whole; i < count; ++i) {
    low = samples[i] < low ? samples[i] : low;
    high = samples[i] > high ? samples[i] : high;
    missing += samples[i] != samples[i] ? 1 : 0;
  }
}

void TraceMeter::Block::join(const Block& later) {
  low = std::min(low, later.low);
  high = std::max(high, later.high);
  missing += later.missing;
}

void TraceMeter::push(std::span<const double> samples) {
  while (!samples.empty()) {
    const std::size_t some = std::min<std::uint64_t>(samples.size(), length_ - filled_);
    open_.take(samples.data(), some);
    filled_ += some;
    samples = samples.subspan(some);
    if (filled_ == length_) close();
  }
}

void TraceMeter::close() {
  blocks_.push_back(open_);
  open_ = {};
  filled_ = 0;
  if (blocks_.size() == kMostBlocks) halve();
}

// A block without a partner is part of the one that is open.
void TraceMeter::halve() {
  for (std::size_t i = 0; i < blocks_.size() / 2; ++i) {
    Block pair = blocks_[2 * i];
    pair.join(blocks_[2 * i + 1]);
    blocks_[i] = pair;
  }
  if (blocks_.size() % 2 != 0) {
    Block last = blocks_.back();
    last.join(open_);
    open_ = last;
    filled_ += length_;
  }
  blocks_.resize(blocks_.size() / 2);
  length_ *= 2;
}

void TraceMeter::join(TraceMeter later) {
  while (length_ < later.length_) halve();
  while (later.length_ < length_) later.halve();
  if (filled_ != 0) {  // a short part within the block that is open
    if (!later.blocks_.empty() || filled_ + later.filled_ > length_)
      throw std::logic_error("traces joined where a block straddles");
    open_.join(later.open_);
    filled_ += later.filled_;
    if (filled_ == length_) close();
    return;
  }
  blocks_.insert(blocks_.end(), later.blocks_.begin(), later.blocks_.end());
  open_ = later.open_;
  filled_ = later.filled_;
  while (blocks_.size() >= kMostBlocks) halve();
}

void TraceMeter::write_state(StateWriter& to) const {
  to.number(length_);
  to.number(filled_);
  std::vector<Block> all = blocks_;
  all.push_back(open_);
  to.number(all.size());
  for (const Block& b : all) {
    to.real(b.low);
    to.real(b.high);
    to.number(b.missing);
  }
}

void TraceMeter::read_state(StateReader& from) {
  length_ = from.number();
  filled_ = from.number();
  blocks_.resize(from.count(24));
  for (Block& b : blocks_) {
    b.low = from.real();
    b.high = from.real();
    b.missing = from.number();
  }
  if (blocks_.empty() || blocks_.size() > kMostBlocks || !std::has_single_bit(length_) ||
      filled_ >= length_)
    from.refuse("the trace of a channel");
  open_ = blocks_.back();
  blocks_.pop_back();
}

Trace TraceMeter::finish() const {
  Trace out;
  out.block = length_;
  std::vector<Block> all = blocks_;
  if (filled_ > 0) all.push_back(open_);
  for (const Block& b : all) {
    const bool any = b.low <= b.high;
    out.low.push_back(any ? b.low : std::numeric_limits<double>::quiet_NaN());
    out.high.push_back(any ? b.high : std::numeric_limits<double>::quiet_NaN());
    out.missing.push_back(b.missing);
  }
  return out;
}

}  // namespace libchar

#include "libchar/characterize/trace.hpp"

#include <algorithm>
#include <limits>

namespace libchar {
namespace {

constexpr std::size_t kMostBlocks = 800;
constexpr std::size_t kLanes = 4;

}  // namespace

// Comparisons with NaN are false: missing samples change no extreme. Four lanes, because one waits for itself.
void TraceMeter::Block::take(const double* samples, std::size_t count) {
  double lows[kLanes] = {low, low, low, low}, highs[kLanes] = {high, high, high, high};
  std::uint64_t absent = 0;
  const std::size_t whole = count - count % kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double x = samples[i + lane];
      lows[lane] = x < lows[lane] ? x : lows[lane];
      highs[lane] = x > highs[lane] ? x : highs[lane];
      absent += x != x ? 1 : 0;
    }
  for (std::size_t i = whole; i < count; ++i) {
    lows[0] = samples[i] < lows[0] ? samples[i] : lows[0];
    highs[0] = samples[i] > highs[0] ? samples[i] : highs[0];
    absent += samples[i] != samples[i] ? 1 : 0;
  }
  low = *std::min_element(lows, lows + kLanes);
  high = *std::max_element(highs, highs + kLanes);
  missing += absent;
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
  if (blocks_.size() < kMostBlocks) return;
  for (std::size_t i = 0; i < blocks_.size() / 2; ++i) {
    Block pair = blocks_[2 * i];
    pair.join(blocks_[2 * i + 1]);
    blocks_[i] = pair;
  }
  blocks_.resize(blocks_.size() / 2);
  length_ *= 2;
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

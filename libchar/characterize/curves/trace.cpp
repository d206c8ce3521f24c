#include "libchar/characterize/curves/trace.hpp"

#include <algorithm>
#include <limits>

#include "libchar/core/numeric/lanes.hpp"

namespace libchar {

// Comparisons with NaN are false: missing samples change no extreme. A comparison that holds is minus one.
LIBCHAR_WIDE_LANES void TraceMeter::Block::take(std::span<const double> taken) {
  const double* const samples = taken.data();
  const std::size_t count = taken.size();
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

Trace TraceMeter::finish() const {
  Trace out;
  out.block = all_.length;
  std::vector<Block> blocks = all_.parts;
  if (all_.filled > 0) blocks.push_back(all_.open);
  for (const Block& b : blocks) {
    const bool any = b.low <= b.high;
    out.low.push_back(any ? b.low : std::numeric_limits<double>::quiet_NaN());
    out.high.push_back(any ? b.high : std::numeric_limits<double>::quiet_NaN());
    out.missing.push_back(b.missing);
  }
  return out;
}

}  // namespace libchar

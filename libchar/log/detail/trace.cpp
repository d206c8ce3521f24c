#include <algorithm>
#include <limits>

#include "libchar/core/numeric/lanes.hpp"
#include "libchar/log/quality.hpp"

namespace libchar {

namespace {

struct Extremes {
  double low, high;
  std::uint64_t missing;
};

// Comparisons with NaN are false: missing samples change no extreme. A comparison that holds is minus one.
LIBCHAR_LANES void widen_lanes(const double* samples, std::size_t count, Extremes& seen) {
  Four lows = Four{} + seen.low, highs = Four{} + seen.high;
  auto absent = lows != lows;
  const std::size_t whole = count - count % 4;
  for (std::size_t i = 0; i < whole; i += 4) {
    const Four x = LIBCHAR_FOUR(samples + i);
    lows = x < lows ? x : lows;
    highs = x > highs ? x : highs;
    absent += x != x;
  }
  for (int lane = 0; lane < 4; ++lane) {
    seen.low = std::min(seen.low, lows[lane]);
    seen.high = std::max(seen.high, highs[lane]);
    seen.missing -= static_cast<std::uint64_t>(absent[lane]);
  }
  for (std::size_t i = whole; i < count; ++i) {
    seen.low = samples[i] < seen.low ? samples[i] : seen.low;
    seen.high = samples[i] > seen.high ? samples[i] : seen.high;
    seen.missing += samples[i] != samples[i] ? 1 : 0;
  }
}
constexpr InLanes<widen_lanes> widen;

}  // namespace

void TraceMeter::Block::take(std::span<const double> samples) {
  Extremes seen{low, high, missing};
  widen(samples.data(), samples.size(), seen);
  low = seen.low;
  high = seen.high;
  missing = seen.missing;
}

void TraceMeter::Block::join(const Block& later) {
  low = std::min(low, later.low);
  high = std::max(high, later.high);
  missing += later.missing;
}

Trace TraceMeter::finish(std::size_t most) const {
  Trace out;
  detail::Halving<Block, kMost> all = all_;
  while (all.parts.size() >= most) all.halve();
  out.block = all.length;
  if (all.filled > 0) all.parts.push_back(all.open);
  for (const Block& b : all.parts) {
    const bool any = b.low <= b.high;
    out.low.push_back(any ? b.low : std::numeric_limits<double>::quiet_NaN());
    out.high.push_back(any ? b.high : std::numeric_limits<double>::quiet_NaN());
    out.missing.push_back(b.missing);
  }
  return out;
}

}  // namespace libchar

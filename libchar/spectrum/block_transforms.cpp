#include "libchar/spectrum/block_transforms.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/spectrum/detail/half_segments.hpp"
#include "libchar/spectrum/detail/welch_workspace.hpp"

namespace libchar {

// Paired as WelchStream pairs them: 0 and 1, 2 and 3…, and a last one alone.
void BlockTransforms::take(std::span<const double> part, BlockTaker& taker) const {
  HalfSegments halves(2 * block_, workspace_ != nullptr ? &workspace_->state().pools : nullptr);
  SharedBlocks blocks(block_, taker);
  const auto next = [&]() -> HalfSegments::Half {
    if (part.size() < block_) return {};
    HalfSegments::Half half = halves.half_at(part.data());
    half.block = blocks.offer(part.first(block_), std::isfinite(half.mean));
    part = part.subspan(block_);
    return half;
  };
  while (part.size() >= block_) {
    const HalfSegments::Half first = next(), second = next();
    halves.push(first, second, nullptr, nullptr);
  }
  blocks.close(part, halves.block_power());
}

}  // namespace libchar

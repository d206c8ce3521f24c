#pragma once
// The transforms that a spectrum shares with the fit, where no spectrum is wanted.

#include <cstdint>
#include <span>

#include "libchar/core/shared_blocks.hpp"
#include "libchar/spectrum/welch.hpp"

namespace libchar {

/// Squared cosine transforms of blocks of half a segment, with the bits that `WelchParts` gives them.
class BlockTransforms {
 public:
  /// `block`: half a segment that Welch's method takes by halves. `workspace`: shared with others, and must live as long.
  explicit BlockTransforms(std::uint64_t block, WelchWorkspace* workspace = nullptr)
      : block_(block), workspace_(workspace) {}
  /// One part of a record.
  void take(std::span<const double> part, BlockTaker& taker) const;

 private:
  std::uint64_t block_ = 0;
  WelchWorkspace* workspace_ = nullptr;
};

}  // namespace libchar

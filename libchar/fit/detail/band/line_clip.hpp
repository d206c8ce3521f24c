#pragma once
// Spectral lines in squared transform coefficients, and what to leave out because of them.

#include <cstdint>
#include <vector>

namespace libchar {

struct LineClip {
  std::vector<char> clipped;  ///< one flag a coefficient; empty when none is clipped
  std::uint64_t count = 0;    ///< coefficients left out, times nothing: not weighted by pooling
};

/// `mean[i]` is the mean square of coefficient first + i over `pooled` transforms. Coefficients
/// below 32 are never clipped.
LineClip clip_lines(const std::vector<double>& mean, std::uint64_t first, std::uint64_t pooled);

}  // namespace libchar

#pragma once
// One Fourier transform of each half segment, for Welch's method with half-overlapping Hann
// segments and for a block cosine transform.

#include <cstddef>
#include <memory>
#include <vector>

#include "libchar/spectrum/spectrum.hpp"

namespace libchar {

/// Takes the halves of half-overlapping segments one after the other. What a segment's transform is
/// made of depends on its two halves only, so that any half may be the first.
class HalfSegments {
 public:
  /// Hann window, overlap of one half, mean removed, and a length that splits well.
  static bool suits(const WelchOptions& options);

  explicit HalfSegments(std::size_t segment);
  ~HalfSegments();
  HalfSegments(HalfSegments&&) noexcept;
  HalfSegments& operator=(HalfSegments&&) noexcept;

  std::size_t half() const;
  /// Mean of a half; not finite when a sample is missing.
  double mean_of(const double* x) const;
  /// The next half and its mean. Adds |X_k|^2 of the segment that it ends to the segments' power
  /// and returns true; false when it or the half before is not whole, or there is none before. With
  /// `block`, a whole half also adds the squares of its orthonormal DCT-II to the blocks' power.
  bool push(const double* x, double mean, bool block);
  /// The next half stands alone.
  void forget();

  /// Sums since the last call: bins 0 … half of the segments; and starts them from zero.
  void take_power(std::vector<double>& power);
  std::vector<double> power() const;
  /// Sums of c_k^2, k = 0 … half-1 (k = 0: not filled), over all blocks.
  std::vector<double> block_power() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace libchar

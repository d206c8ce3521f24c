#pragma once
// One Fourier transform of two half segments at a time, for Welch's method with half-overlapping
// Hann segments and for a block cosine transform.

#include <cstddef>
#include <vector>

#include "libchar/core/hidden.hpp"
#include "libchar/spectrum/welch.hpp"

namespace libchar {

namespace half_segments {
class RowPools;
}

/// Takes the halves of half-overlapping segments two by two: A, B after P gives the segments (P, A)
/// and (A, B). The bits of a half depend on the one it is paired with, so that who wants the same
/// bits pairs alike: halves 0 and 1, 2 and 3, and so on.
class HalfSegments {
 public:
  /// Hann window, overlap of one half, mean removed, and a length that splits well.
  static bool suits(const WelchOptions& options);

  /// `pools`: tables and memory that several share, from any number of threads; none: its own.
  explicit HalfSegments(std::size_t segment, half_segments::RowPools* pools = nullptr);

  std::size_t half() const;

  struct Half {
    const double* samples = nullptr;  ///< none: not there
    double mean = 0;                  ///< not finite: a sample is missing
    bool block = false;               ///< a whole half adds the squares of its orthonormal DCT-II to the blocks'
  };
  Half half_at(const double* samples, bool block = false) const;

  /// Sums of |X_k|^2 over segments, in the order of this object.
  class Sums;
  using SumsPointer = detail::Hidden<Sums>;
  SumsPointer zero_sums() const;
  SumsPointer copy_of(const Sums& sums) const;
  /// Bins 0 … half; and starts the sums from zero.
  void take_power(Sums& sums, std::vector<double>& power) const;

  /// Which of the two segments that a pair ends are made of whole halves.
  struct Used {
    bool first = false, second = false;
  };
  /// The next two halves. Adds the power of the segments they end to `first` and `second` (which
  /// may be the same; none: not wanted).
  Used push(const Half& a, const Half& b, Sums* first, Sums* second);
  /// The segment that a last half without a partner ends; nothing is remembered of it.
  bool add_last(const Half& a, Sums& sums) const;
  /// The next pair stands alone.
  void forget();

  /// Sums of c_k^2, k = 0 … half-1 (k = 0: not filled), over all blocks.
  std::vector<double> block_power() const;

 private:
  struct State;
  detail::Hidden<State> state_;
};

}  // namespace libchar

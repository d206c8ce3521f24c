#pragma once
// The running sum of a record, kept so that its differences lose no digits to offset or drift.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace libchar {

/// A sum of two doubles, high + low, |low| <= ulp(high)/2: twice the digits (Dekker 1971).
struct DoubleDouble {
  double high = 0, low = 0;
};
DoubleDouble operator+(DoubleDouble a, DoubleDouble b);
DoubleDouble operator*(DoubleDouble a, double k);

/// Half-open range of indices.
struct IndexRange {
  std::size_t begin = 0, end = 0;
};

/// Phase x_p = y_0 + … + y_{p-1} of a rate record (or a phase record itself) and, for the modified
/// variance, its own sum W_p = x_0 + … + x_{p-1}, each stored as  base of the block (as two doubles) +
/// polynomial + small local rest (double):
///   x_{bL+j} = X_b + j A_b + local_{bL+j},
///   W_{bL+j} = W_b + j X_b + j(j-1)/2 A_b + local2_{bL+j},
/// A_b the first sample of block b less the first of the record. The local rests are sums of at most L deviations from
/// a neighbour, so an offset cancels before anything is added, and a drift up to its change within one block.
struct AnchoredPhase {
  static constexpr std::size_t kBlock = 1024;  // L
  std::size_t points = 0;                      ///< of x; W has one more
  double scale = 1;                            ///< power of two by which all was multiplied
  bool summed = false;                         ///< local2 and W are there
  std::vector<double> local, local2;
  std::vector<DoubleDouble> anchor, base, base2;  ///< A_b, X_b, W_b
  std::vector<IndexRange> stretches;              ///< of phase points between missing samples
  std::size_t missing = 0;
};

/// A power of two that brings the largest deviation from the first sample near 1, so that squares
/// neither overflow nor vanish; being a power of two it changes no bit of the result.
double balancing_scale(std::span<const double> record);

AnchoredPhase anchored_phase_of_rate(std::span<const double> rate, bool summed);
AnchoredPhase anchored_phase_of_phase(std::span<const double> phase, bool summed);

/// Sum over the term starts i = first, first + stride, … < last of the squared `order`-th
/// difference at step m of x, or of W when `of_sum` (order 2 or 3). Every position first … last - 1
/// + order m must exist.
double sum_of_squares(const AnchoredPhase& phase, int order, bool of_sum, std::size_t m, std::size_t first,
                      std::size_t last, std::size_t stride);

}  // namespace libchar

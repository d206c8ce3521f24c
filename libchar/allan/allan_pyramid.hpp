#pragma once
// The overlapping Allan deviation of a stream, at octaves, in constant memory.

#include <cstdint>
#include <span>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/allan_sums.hpp"
#include "libchar/core/hidden.hpp"

namespace libchar {

/// `AllanCurve::stride_divisor` of its curves.
inline constexpr std::uint64_t kPyramidStride = 4;

/// Streaming overlapping Allan deviation at octaves in constant memory: m = 1, 2, 4 at stride 1, m >= 8 at stride m/4
/// (docs/theory/allan.md). One pass, no cumulative sum over the record. Result independent of block boundaries.
class AllanPyramid {
 public:
  AllanPyramid();
  /// One that has seen a record elsewhere, part by part; no more samples come.
  explicit AllanPyramid(const AllanSums& sums);
  void push(std::span<const double> samples);
  AllanCurve finish(double dt_s) const&;
  AllanCurve finish(double dt_s) &&;  ///< the same, where no more samples come
  /// What it has found, to be joined to the parts of the record before and behind; no more samples come.
  AllanSums sums() &&;

 private:
  struct State;
  detail::Hidden<State> state_;
};

/// The curve of a whole record at once.
AllanCurve pyramid_deviation(std::span<const double> record, double dt_s);

}  // namespace libchar

#pragma once
// Slow cycles of a record (heating, air conditioning, day and night), taken out of the coefficients of a transform.

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "libchar/fit/record/power_bins.hpp"

namespace libchar::detail {

/// As many coefficients as a slow cycle is looked for in, and its leak taken out of.
inline constexpr std::size_t kCycleReach = 8192;

/// The coefficients k = 1.. of the orthonormal DCT-II of n points of cos(w u) and sin(w u), w = pi place / n,
/// u = t + 1/2: a sine of `place` half periods.
struct SineColumns {
  double half_unit, half_sine, half_cosine, scale, sine, cosine;
  SineColumns(double place, std::size_t n);
  Eigen::RowVector2d at(std::size_t k) const;
  /// The same, with sine and cosine of k `half_unit`.
  Eigen::RowVector2d at(std::size_t k, double sine_k, double cosine_k) const {
    const double sum = half_sine * cosine_k + half_cosine * sine_k, less = half_sine * cosine_k - half_cosine * sine_k;
    const double far = scale * 2 * half_sine * cosine_k / (sum * less), sign = k % 2 == 0 ? 1 : -1;
    return {far * sign * sine, far * (1 - sign * cosine)};
  }
};

/// Off the coefficients themselves, where both factors are zero over zero.
double off_grid(double place);

/// The sines that stand out of the first coefficients of an orthonormal DCT-II of `length` points
/// so far that what they leak reaches the slow end, where a line cannot be left out. They are
/// subtracted from `coefficients`; none where nothing stands out.
std::vector<PooledPower::Cycle> take_out_cycles(std::span<double> coefficients, std::size_t length);

}  // namespace libchar::detail

#pragma once
// Channels that hold one sensor twice: equal sample by sample, as far as a float tells, or one a straight line of the
// other, as far as both are rounded. Of a line y = a x + b by least squares, what is left has the variance
//   s² = (Syy - Sxy² / Sxx) / n,   of rounding alone (q_y² + a² q_x²) / 12,
// q the last decimal that is recorded (0 beyond nine), or that of seven digits. Two sensors with noises of their own
// have more, unless both are coarse.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace libchar {

enum class Likeness { none, line, equal };

class CopiedSensors {
 public:
  /// Consecutive samples of all channels; NaN: missing.
  void push(std::span<const std::span<const double>> channels);
  /// Throughout, in a hundred instants at least.
  Likeness between(std::size_t a, std::size_t b) const;

 private:
  struct Channel {
    double last = 0, squares = 0;  ///< sample, sum of squared steps
    std::uint64_t samples = 0, moves = 0;
    int decimals = 0;  ///< that all samples have; kNoGrid: more than are looked at
    double grid() const;
    void take(double value);
  };
  struct Sums {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;  // count, means, squares about them
    bool equal = true;
  };
  struct Pair {
    std::size_t x, y;
    Sums sums;
  };
  static Sums sums_of(std::span<const double> x, std::span<const double> y);
  static void merge(const Sums& more, Sums& all);
  void find_pairs(std::span<const std::span<const double>> channels);
  bool on_line(const Pair& pair, const Sums& sums) const;
  std::vector<Channel> channels_;
  std::vector<Pair> pairs_;
  bool begun_ = false;
};

}  // namespace libchar

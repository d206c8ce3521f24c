#pragma once
// The sampling interval behind a series of time stamps, in bounded memory.
//
// The rate that is reported is the median of long-baseline slopes (Theil 1950, in the half-length
// form) over a thinned set of (grid index, stamp) pairs. What tells a gap from a step is decided
// before, by first_interval.hpp.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace libchar {

/// A bounded, evenly thinned set of (grid index, stamp) pairs that also keeps the most deviating
/// pair of every stretch.
class StampSketch {
 public:
  void add(std::int64_t index, std::int64_t stamp) {
    if (in_cell_ == 0) return begin_cell({index, stamp});
    --in_cell_;
    const double r = residual({index, stamp});
    if (r < low_) {
      low_ = r;
      cells_.back().low = {index, stamp};
    }
    if (r > high_) {
      high_ = r;
      cells_.back().high = {index, stamp};
    }
  }
  /// n rising stamps of consecutive grid indices: the same as one by one.
  void add_run(std::int64_t index, const std::int64_t* stamps, std::size_t n);
  /// ns per grid step by the median of long-baseline slopes; 0 with fewer than two pairs.
  double interval_ns() const;
  /// The same by least squares: of stamps on a coarse grid, whose slopes are fractions of its step.
  double line_ns() const;
  /// 1.4826 MAD and largest |stamp minus grid| for that interval, in ns.
  struct Deviation {
    double robust = 0, largest = 0;
  };
  Deviation deviation(double interval_ns) const;

 private:
  struct Pair {
    std::int64_t index = 0, stamp = 0;
  };
  struct Cell {
    Pair first, low, high;
  };
  double residual(const Pair& pair) const {
    return static_cast<double>(pair.stamp - origin_.stamp) -
           slope_ * static_cast<double>(pair.index - origin_.index);
  }
  void begin_cell(const Pair& pair);
  void extremes(
      const std::int64_t* stamps, std::size_t n, const Pair& from, double& low, double& high) const;
  void thin();
  std::vector<Cell> cells_;
  Pair origin_;                // the very first
  double low_ = 0, high_ = 0;  // residuals in the cell under way
  std::uint64_t per_cell_ = 1, in_cell_ = 0;
  double slope_ = 0;  // provisional, to tell which pair of a cell deviates most
  static constexpr std::size_t kCells = 4096;
};

}  // namespace libchar

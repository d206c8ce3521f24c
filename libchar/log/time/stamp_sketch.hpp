#pragma once
// The sampling interval behind a series of time stamps, in bounded memory.
//
// The rate that is reported is the median of long-baseline slopes (Theil 1950, in the half-length form) over a thinned
// set of (grid index, stamp) pairs. A pause is left out: how many samples it lacks follows from the rate, so it says
// nothing of it. What tells a gap from a step is decided before, by stamp_model.hpp.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "libchar/log/time/stamp_model.hpp"

namespace libchar {

/// A bounded, evenly thinned set of (grid index, stamp) pairs that also keeps the most deviating pair of every stretch.
class StampSketch {
 public:
  void add(std::int64_t index, std::int64_t stamp) {
    if (in_cell_ == 0) return begin_cell({index, stamp});
    --in_cell_;
    const Pair pair = from_zero({index, stamp});
    const double r = residual(pair);
    if (r < low_) {
      low_ = r;
      cells_.back().low = pair;
    }
    if (r > high_) {
      high_ = r;
      cells_.back().high = pair;
    }
  }
  /// A pause: so many grid points and so much time are left out from here on.
  void skip(std::int64_t points, std::int64_t time) {
    zero_.index += points;
    zero_.stamp += time;
  }
  /// n rising stamps of consecutive grid indices: the same as one by one.
  void add_run(std::int64_t index, const std::int64_t* stamps, std::size_t n);
  /// ns per grid step by the median of long-baseline slopes; 0 with fewer than two pairs.
  double interval_ns() const;
  /// The same by least squares: of stamps on a coarse grid, whose slopes are fractions of its step.
  double line_ns() const;
  /// From the first stamp to a last one, pauses left out: ns a grid step.
  double span_ns(std::int64_t index, std::int64_t stamp) const {
    return index <= zero_.index ? 0
                                : static_cast<double>(stamp - zero_.stamp) / static_cast<double>(index - zero_.index);
  }
  /// A change of rate (find_rate_change), its row in ns after the first stamp, pauses included; in the first of so
  /// many parts of the log.
  std::optional<RateChange> rate_change(std::size_t parts = 1) const;
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
    Pair first, low, high;         // from zero_ on
    std::int64_t after_first = 0;  // the first's stamp, pauses included
  };
  Pair from_zero(const Pair& pair) const { return {pair.index - zero_.index, pair.stamp - zero_.stamp}; }
  double residual(const Pair& from_zero) const {
    return static_cast<double>(from_zero.stamp) - slope_ * static_cast<double>(from_zero.index);
  }
  void begin_cell(const Pair& pair);
  void extremes(const std::int64_t* stamps, std::size_t n, const Pair& from, double& low, double& high) const;
  void thin();
  std::vector<Cell> cells_;
  Pair zero_;  // the very first, moved on by what was left out
  std::int64_t first_stamp_ = 0;
  double low_ = 0, high_ = 0;  // residuals in the cell under way
  std::uint64_t per_cell_ = 1, in_cell_ = 0;
  double slope_ = 0;  // provisional, to tell which pair of a cell deviates most
  static constexpr std::size_t kCells = 4096;
};

}  // namespace libchar

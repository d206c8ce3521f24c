#pragma once
// What is done to all sensors and the reference alike before anything is learnt or fused: a trend
// is taken out of each, and one filter runs over all.

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "libchar/replay/detail/plan/band_filter.hpp"

namespace libchar {

/// A straight line over the instants.
struct TrendLine {
  double level = 0;   ///< at `middle`
  double slope = 0;   ///< an instant
  double middle = 0;  ///< instant
  double at(std::int64_t instant) const { return level + slope * (static_cast<double>(instant) - middle); }
};

/// The mean, or the line of least squares, of each of several series; NaN = missing. One pass, constant memory.
class TrendMeter {
 public:
  /// Consecutive instants from `first` on, a column each, a row a series.
  void push(std::int64_t first, const Eigen::MatrixXd& series);
  /// `sloped`: lines, else means. A series without samples has a line of zeros.
  std::vector<TrendLine> lines(bool sloped) const;

 private:
  // Moments about the running means: an offset, or a late time, costs no digits.
  struct Sums {
    double n = 0, time = 0, value = 0, time_squares = 0, products = 0;
  };
  std::vector<Sums> sums_;
};

struct Preparation {
  std::vector<TrendLine> trends;  ///< a row each; empty: none is taken out
  std::optional<BandFilter> filter;
  bool idle() const { return trends.empty() && !filter; }
};

/// One pass over all rows.
class Prepared {
 public:
  Prepared(const Preparation& preparation, std::size_t rows);
  /// The instants of a row come in order from the first one on.
  double operator()(std::size_t row, std::int64_t instant, double value);

 private:
  const Preparation* preparation_;
  std::vector<FilteredChannel> channels_;
};

}  // namespace libchar

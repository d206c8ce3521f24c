#pragma once
// Values over time, thinned until a plot can show them.

#include <vector>

namespace libchar {

/// Values over time, thinned to bins: the smallest and the largest in each. Empty: nothing to show.
struct Timeline {
  std::vector<double> time_s;  ///< middle of each bin, seconds from the recording's first sample
  std::vector<std::vector<double>> low, high;  ///< [series][bin]; NaN: no value in this bin
  bool empty() const { return time_s.empty(); }
};

}  // namespace libchar

#pragma once
// How many values lie where.

#include <cstdint>
#include <span>
#include <vector>

namespace libchar {

/// Bins of one width; what lies far off stands in `below` and `above`, so that one wild value does not squeeze all others into a bin.
struct Histogram {
  double low = 0, step = 1;          ///< bin k reaches from low + k step to the next
  std::vector<std::uint64_t> count;  ///< empty: of no values
  std::uint64_t below = 0, above = 0;
};

/// Width by Freedman & Diaconis, 2 (interquartile range) / n^(1/3); 1 to 60 bins within eight robust deviations of the median.
Histogram histogram_of(std::span<const double> values);

}  // namespace libchar

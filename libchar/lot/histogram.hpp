#pragma once
// How many values lie where, and how well the devices of a lot keep a limit.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/numeric/random_effects.hpp"

namespace libchar {

struct Capability {
  double most = 0;   ///< the limit, in the unit of the values
  std::string text;  ///< as its file says it
  std::size_t pass = 0, fail = 0,
              not_decided = 0;  ///< devices; each by the interval of its own value
  /// (limit - mean) / (3 spread) in logarithms, by the devices' own mean and spread; infinite: no spread is seen
  std::optional<double> ppk;
  Interval ppk_ci95;
  /// The same with the deviation from one device to the next of the control chart, which holds the uncertainty of each as well.
  std::optional<double> cpk;
  double above =
      0;  ///< share of devices above the limit that a normal distribution with that ppk has
};

/// Fills ppk, its interval and `above`. `limit` as what `effects` is of.
void add_ppk(const RandomEffects& effects, double limit, Capability& out);

/// Bins of one width; distant values are in `below` and `above`, so that one wild value does not squeeze all others into a bin.
struct Histogram {
  double low = 0, step = 1;          ///< bin k reaches from low + k step to the next
  std::vector<std::uint64_t> count;  ///< empty: of no values
  std::uint64_t below = 0, above = 0;
};

/// Width by Freedman & Diaconis, 2 (interquartile range) / n^(1/3); 1 to 60 bins within eight robust deviations of the median.
Histogram histogram_of(std::span<const double> values);

}  // namespace libchar

#pragma once
// What noise puts into the cosine transform of a series of means: the measure that events are found against.

#include <cstdint>
#include <functional>
#include <vector>

#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/signs/event_series.hpp"

namespace libchar {

/// E c_k^2, k = 1..n-1 at [k-1], of the orthonormal DCT-II of a series of n values, according to the noise that the caller fits to it.
using NoisePowers = std::function<std::vector<double>(const EventSeries& series)>;

/// The mixture of white noise, flicker and walk that fits a series from its slowest coefficients up, as far as it describes them:
/// what `find_events` uses where the caller has no better.
NoisePowers fitted_powers();

}  // namespace libchar

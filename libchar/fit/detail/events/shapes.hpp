#pragma once
// The cosine transforms of steps, warm-ups and ramps, in closed form.

#include <cstdint>
#include <vector>

#include "libchar/fit/signs/event.hpp"
#include "libchar/fit/signs/event_series.hpp"

namespace libchar {

/// What a regressor is, in points of a series: of unit size (EventSeries: step 1, warm-up 1 at the first sample, ramp 1 from the
/// first sample to the last).
struct EventShape {
  EventKind kind = EventKind::step;
  /// step: the first point after it; 10.3 is a step within point 10, which has seven tenths of it
  double at = 0;
  double bridged =
      0;  ///< step: it was while this many points were missing, bridged from `at` on by a line
  double tau = 0;  ///< warm-up: time constant
};

/// Where a series stands: n points of `per_point` samples.
struct SeriesGrid {
  std::uint64_t points = 0, per_point = 1;
};

/// Coefficients k = 1.. of the orthonormal DCT-II at [k-1], as many as `column` has room for.
void fill_column(const EventShape& shape, const SeriesGrid& grid, std::vector<double>& column);

}  // namespace libchar

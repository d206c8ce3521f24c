#pragma once
// What a run looks like: truth, best method and best single sensor over time.

#include <cstddef>
#include <optional>
#include <vector>

#include "libchar/replay/timeline.hpp"

namespace libchar {

/// One true input over the run; a series each, empty where there is no reference.
struct InputTracks {
  Timeline reference, estimate, error;
};

/// A stretch of a run, thinned to its smallest and largest values: the truth, what one method made
/// of the samples, one sensor.
struct RunStretch {
  std::vector<InputTracks> inputs;  ///< empty: nothing ran
  Timeline sensor, sensor_error;    ///< of `best_sensor`, divided by its h: in the input's unit
  /// without a reference: of each sensor, divided by its h, from the median of all; a series a
  /// sensor. Empty where sensors do not see one input in one unit.
  Timeline deviations;
};

/// A short stretch, every instant of it.
struct CloseUp {
  std::optional<std::size_t> fault;  ///< around the start of this one of ReplayResult::faults
  double from_s = 0, to_s = 0;
  RunStretch run;
};

/// What a run looks like: the best method beside the best single sensor.
struct RunTracks {
  std::optional<std::size_t> algorithm;  ///< whose estimate: the best, else the first in the order
  RunStretch whole;
  std::vector<CloseUp> close_ups;  ///< rising; empty where `whole` has every instant
};

}  // namespace libchar

#pragma once
// The samples of a true signal that comes from a log.

#include <string>

#include "libchar/core/finding.hpp"
#include "libchar/simulate/sensor_array.hpp"

namespace libchar {

/// Reads the log of a signal of kind recording into it, and leaves every other kind as it is. The
/// path is used unchanged, not relative to a scene. A log that is shorter than the simulation is a
/// warning; one of another rate, with several channels or without a sample is Error(usage) at
/// `place`.
void read_recorded_signal(SignalSpec& signal,
                          const std::string& place,
                          const ArraySimulation& simulation,
                          Findings& warnings);

}  // namespace libchar

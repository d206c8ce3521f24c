#pragma once
// Which sensors read otherwise than the rest, and what is said of them: for a part of the run, drifting through it, or
// throughout. Offset, gain, the logarithm of the noise and that of its slow part are judged each against those of the
// others by Student's t, where what sound sensors scatter by counts as three more of them. Beyond what chance does in
// one sound array of 300 a sensor stands apart; beyond what it does in one of 20 it is unlike the others, and a fault
// cannot be distinguished from its kind: of three sensors two say little about the third.

#include "libchar/replay/detail/plan/reading_meter.hpp"
#include "libchar/replay/detail/plan/step_noise.hpp"

namespace libchar::detail {

/// Of the instants that a meter saw.
struct Clock {
  double start_s = 0, rate_hz = 1;
};

/// What was read in a run.
struct RunReadings {
  const ReadingMeter& meter;
  const ReadingMeter* beside_truth = nullptr;  ///< the same sensors beside a reference
  std::vector<StepNoiseMeter::Change> noise = {};
  double noise_from_s = 0;  ///< time of the first instant of these
};

/// Sensors that read otherwise than they do for most of the log they are judged by, or than all
/// others throughout. `taken_out`: what the meter did not see. `reference`: the last of them is no sensor.
void warn_of_readings(const RunReadings& run, const std::vector<std::string>& names,
                      const std::vector<std::string>& units, const Clock& clock, const std::vector<TakenOut>& taken_out,
                      bool reference, Findings& warnings);

/// Where no alignment has looked for delays.
void warn_of_delays(const std::vector<ReadingMeter::Delay>& delays, const std::vector<std::string>& names,
                    Findings& warnings);

/// A finding that says of sensors that they fail, stand apart, repeat each other, or have no samples.
bool doubts_sensors(const Finding& finding);

/// Of another log than that of `learnt`.
void warn_of_changes(const ReadingMeter& meter, const ReadingMeter::Readings& learnt,
                     const std::vector<std::string>& names, const std::vector<std::string>& units, const Clock& clock,
                     Findings& warnings);

}  // namespace libchar::detail

#pragma once
// What the values of a reference that is slower than the sensors stand for.

#include <string>
#include <vector>

#include "libchar/replay/detail/align/reference_track.hpp"

namespace libchar {

struct SlowReading {
  std::string samples;  ///< of SceneReference::kReadings
  double lag_s = 0;     ///< the sensors lag the reference by this
  /// log-likelihood above that of the next reading; 0: nothing was estimated
  double margin = 0;
};

/// Where the interval of a value stands in `samples`, in intervals from its stamp; instant: 0.
double interval_start(const std::string& samples);

struct SlowQuestion {
  std::string samples;  ///< as declared, or estimate
  double lag_s = 0;
  bool estimate_lag = false;
};

/// `level`: the sensors' common value at each sample of the recording, at `rate_hz` (NaN: missing).
/// Each reading predicts the reference by it: a sample by the level at its stamp, a mean by that of
/// the level over the interval. The most likely one is taken, with its lag where that is asked for.
SlowReading read_slowly(const SlowQuestion& question, const std::vector<double>& level, double rate_hz,
                        const ReferenceTrack& track, const std::vector<double>& reference);

}  // namespace libchar

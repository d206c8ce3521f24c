#pragma once
// A reference on a grid of its own, in memory: truth at any time, or over any of its intervals.

#include <string>
#include <vector>

#include "libchar/core/process/progress.hpp"
#include "libchar/replay/detail/scene_source.hpp"

namespace libchar {

struct ReferenceTrack {
  double start_s = 0;  ///< of its first sample, on the clock of the scene's recording (0: its first sample)
  double rate_hz = 0;
  std::vector<std::vector<double>> values;  ///< [channel][sample], NaN: missing
  std::vector<std::string> units;
  double period = 0;  ///< of an angle: neighbours are joined the short way round; 0: no angle
  LogInfo log;

  /// Linear between samples; NaN beyond the ends and beside missing samples.
  double at(std::size_t channel, double time_s) const;
  /// The same by the cubic through four samples (of an angle, and where one of them is missing: linear).
  double curved(std::size_t channel, double time_s) const;
};

/// Reads the reference of a scene: from a log of its own, or from the recording itself.
/// A value between two neighbours, `share` of the way; `period` as above.
double between(double a, double b, double share, double period);

/// A full turn in this unit of angle ("deg": 360, anything unknown: 2 pi).
double full_turn(const std::string& unit);

ReferenceTrack read_reference(const Scene& scene, const SceneSource& source, Progress& progress);

// What the values of a reference that is slower than the sensors stand for.

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

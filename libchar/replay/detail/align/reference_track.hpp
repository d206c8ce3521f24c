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

}  // namespace libchar

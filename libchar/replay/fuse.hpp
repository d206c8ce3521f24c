#pragma once
// A log fused with what a replay learnt (fusion_file.hpp): nothing is learnt here, no reference is needed,
// and memory does not grow with the log.

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libchar/core/process/progress.hpp"
#include "libchar/log/read.hpp"
#include "libchar/replay/fusion_file.hpp"
#include "libchar/replay/replay.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {

struct FuseOptions {
  ReadOptions reading;    ///< of the log; `channels` must be empty
  std::string algorithm;  ///< label; empty: the recommended one
  /// {sensor of the file, channel of the log}; others are found under the channel that the file names.
  std::vector<std::pair<std::string, std::string>> map;
  /// Time at the start of this log in which no sensor fails; none: not known, but of the log that was learnt from.
  std::optional<double> fault_free_s;
  std::size_t block = 0;  ///< instants at once; 0: 4096. Results do not depend on it
};

struct FusedSensor {
  std::string name, channel, unit;  ///< `channel` empty: the log has none for it
  std::uint64_t missing = 0;        ///< instants without a sample
  std::uint64_t out = 0;            ///< instants at which the algorithm had it out
};

struct FuseResult {
  LogInfo log;
  std::string file, file_sha256;  ///< what was applied
  LearntAlgorithm algorithm;
  double rate_hz = 0;
  std::uint64_t instants = 0, estimates = 0;  ///< `estimates`: instants with one of the first input
  std::uint64_t deviations = 0;               ///< of them with a standard deviation
  bool watches_faults = false;
  std::vector<LearntInput> inputs;
  std::vector<FusedSensor> sensors;  ///< of the file, those that were left out of it too
  std::vector<FoundFault> faults;
  Findings warnings;  ///< of the fusion; those of the log are in `log`
};

/// Gives `sink` the inputs, their standard deviations, and one flag per sensor (1: in use, 0: taken out by the
/// algorithm, missing: no sample). Throws Error(input) when log and file do not fit, Error(usage) for an
/// algorithm or sensor that the file does not have.
FuseResult fuse(const std::string& log, const LearntFusion& learnt, ColumnSink& sink, const FuseOptions& options = {},
                Progress& progress = no_progress());

}  // namespace libchar

#pragma once
// What a replay found: everything that its reports show.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/entry.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/replay/algorithm_result.hpp"
#include "libchar/replay/fusion_file.hpp"
#include "libchar/replay/sensor_result.hpp"
#include "libchar/replay/view/run_shown.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {

/// Work done, to prove what was skipped.
struct ReplayWork {
  std::uint64_t passes = 0;       ///< over the recording or simulation
  std::uint64_t learnt = 0;       ///< instants given to learning, summed over algorithms
  std::uint64_t steps = 0;        ///< instants fused, summed over algorithms
  std::uint64_t blind_steps = 0;  ///< the same for leave-one-out and split arrays
};

/// What the fault detector does of a run whose faults are known when one false alarm of the array is
/// accepted in so many seconds.
struct DetectionAt {
  double false_alarm_s = 0;
  std::vector<FaultAnswer> answers;
  std::size_t alarms_without_fault = 0;
};

/// What a result and its report say alike.
struct ReplayFacts {
  std::vector<std::string> plan;  ///< sentences: what was read, learnt, run, skipped and why
  double rate_hz = 0;             ///< of the instants that are fused
  std::uint64_t instants = 0;     ///< of the run
  double start_s = 0;             ///< of the run, seconds from the recording's first sample
  double scored_from_s = 0;       ///< behind the warm-up
  std::optional<TimeWindow> learning;
  TimeWindow evaluation;
  double window_s = 0;  ///< of the window RMS
  std::vector<SensorResult> sensors;
  std::vector<InputResult> inputs;
  /// by `false_alarm_s`; empty: no fault is known, or no algorithm that runs has the detector
  std::vector<DetectionAt> detection;
  /// label of the best method in whose estimates several sensors have a part; "": none has a score
  std::string best_fusion;
  /// the 95 % interval of its RMSE over that of the best sensor; one input and a reference
  std::optional<Interval> best_over_sensor;
  /// no method is called best: without a reference, differences between the sensors' means are nearly all that is seen
  bool offsets_decide = false;

  double end_s() const { return start_s + static_cast<double>(instants) / rate_hz; }
};

struct ReplayResult : ReplayFacts {
  Scene scene;
  std::vector<LogInfo> logs;  ///< the recording, the reference's own log; empty for a simulation
  std::vector<std::string> command;  ///< as typed; set by the caller
  std::vector<Entry> settings;       ///< effective ones, for provenance
  double lag_s = 0;                  ///< the sensors lag the reference by this
  bool lag_estimated = false;
  std::optional<FoundOffset> reference_offset;  ///< where the scene asked for it
  bool has_reference = false;
  std::string reference_use;  ///< "each instant", "mean over its intervals of 3600 s"…
  std::optional<AlignmentResult> alignment;
  std::vector<SensorFault> faults;          ///< that the scene knows, injected or simulated
  std::vector<AlgorithmResult> algorithms;  ///< in the order of the table
  std::optional<std::size_t> best;          ///< of the methods (no bounds) by `rmse`
  std::optional<std::size_t> best_sensor;   ///< of the smallest error; one input and a reference
  RunTracks tracks;
  LearntFusion learnt;  ///< of the array and of every algorithm that ran: what `fuse` applies
  Findings warnings;
  ReplayWork work;
  WorkDone counted{};  ///< all of it
  double seconds = 0;  ///< measured

  /// By its label; null: there is none.
  const AlgorithmResult* find(std::string_view label) const {
    for (const AlgorithmResult& a : algorithms)
      if (a.label == label) return &a;
    return nullptr;
  }
};

}  // namespace libchar

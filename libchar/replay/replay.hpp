#pragma once
// Every fusion algorithm that a scene can run, on one recording.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/process/heap_meter.hpp"
#include "libchar/core/process/progress.hpp"
#include "libchar/replay/column_sink.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {

struct ReplayOptions {
  std::vector<SceneAlgorithm> algorithms;          ///< win over the scene's list; `line` 0
  std::optional<TimeWindow> learning, evaluation;  ///< win over the scene's
  bool published =
      false;  ///< where no list says what runs: also the published forms, next to the robust ones
  double window_s = 0;   ///< of the window RMS; 0: a fiftieth of the run
  bool allan = true;     ///< Allan deviation of each error
  bool no_skip = false;  ///< do all work, whether an output needs it or not: same numbers
  /// processor time that leave-one-out of one algorithm may take, by the declared cost of its steps; beyond it runs on
  /// stretches of the evaluation, or not at all. Infinite: no limit
  double budget_s = 10;
  bool timing =
      true;  ///< measure run times and memory; without them the same input gives the same bytes of a report
  std::size_t block = 0;  ///< instants at once; 0: by length. Results do not depend on it
};

/// Resources of a replay apart from its options; they do not change the result.
struct ReplayWorkspace {
  HeapMeter* heap =
      nullptr;  ///< who can say how much memory an algorithm holds; none: it is not measured
  /// Who wants the estimates; none: they are not kept. Columns: t (seconds from the recording's first sample), the
  /// true inputs (missing without a reference), then label by label, input by input.
  ColumnSink* estimates = nullptr;
};

/// What would be done, in sentences; reads the recording once to know its length and rate.
std::vector<std::string> explain_replay(const Scene& scene,
                                        const ReplayOptions& options = {},
                                        Progress& progress = no_progress());

/// Throws Error(input) when the scene does not fit its recording, Error(numeric) when no algorithm
/// can run.
ReplayResult replay(const Scene& scene,
                    const ReplayOptions& options = {},
                    Progress& progress = no_progress(),
                    const ReplayWorkspace& workspace = {});

}  // namespace libchar

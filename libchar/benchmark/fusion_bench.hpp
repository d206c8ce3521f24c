#pragma once
// Fusion algorithms on scenes, with seeds and options varied: error against time and memory, with
// intervals on both, scene by scene and over all of them.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/benchmark/figure.hpp"
#include "libchar/core/process/heap_meter.hpp"
#include "libchar/core/process/progress.hpp"
#include "libchar/replay/sweep.hpp"

namespace libchar {

/// Built in: the scenes of the source and one of two true inputs.
std::vector<Scene> bench_scenes();

struct FusionBenchOptions {
  std::size_t seeds = 10;  ///< runs of a simulated scene; a recording runs as often for its times
  std::uint64_t seed = 1;  ///< of the first run
  std::vector<std::string> algorithms;  ///< empty: the scene's, else all
  std::vector<Sweep> sweeps;
};

/// One algorithm in one scene.
struct FusionBenchCell {
  bool ran = false;
  std::string why;              ///< it did not, a sentence
  Figure excess;                ///< RMSE over that of the scene's yardstick, minus one
  Figure ns_per_sample;         ///< of an instant
  double learning_s = 0;        ///< median
  std::optional<double> bytes;  ///< of heap, at most
  double front_gap = 0;         ///< of 1 + excess in this scene (detail/pareto.hpp)
};

struct FusionBenchRow {
  std::string label, name;
  bool swept = false;                  ///< one of the options that `sweeps` asked for
  bool bound = false;                  ///< it looked at the reference of the run itself: no method
  std::vector<FusionBenchCell> cells;  ///< one per scene
  /// geometric mean over the scenes that are pooled of RMSE over yardstick, minus one; no count: it did not run in each
  Figure excess;
  Figure ns_per_sample;  ///< geometric mean over the same
  double front_gap = 0;  ///< of 1 + excess (detail/pareto.hpp); NaN: takes no part
};

struct FusionBenchScene {
  std::string name, file;
  std::string yardstick;  ///< "optimal fixed weights", or "best of the methods" without a reference
  std::uint64_t instants = 0;
  std::uint64_t sensors = 0, inputs = 0;
  bool simulated = false;
  std::uint64_t runs = 0;
  bool pooled = false;  ///< one of the most frequent kind: so many true inputs, or a tilt
};

/// A scene that feeds none of the algorithms asked for.
struct FusionBenchLeftOut {
  std::string name, file, why;
};

struct FusionBench {
  std::uint64_t seed = 1;
  std::vector<FusionBenchScene> scenes;
  std::vector<FusionBenchLeftOut> left_out;
  std::vector<FusionBenchRow> rows;  ///< best first over the scenes, then by name
};

/// Throws what `replay` throws; that no algorithm can run on a scene (E0905), only where none can on any.
FusionBench bench_fusion(const std::vector<Scene>& scenes,
                         const FusionBenchOptions& options,
                         Progress& progress = no_progress(),
                         HeapMeter* heap = nullptr);

}  // namespace libchar

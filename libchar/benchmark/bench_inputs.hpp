#pragma once
// What a user wants benchmarks of: models, scenes, logs.

#include <string>
#include <vector>

#include "libchar/benchmark/characterization_bench.hpp"
#include "libchar/log/read.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {

struct BenchInputs {
  std::vector<BenchSignal> signals;
  std::vector<Scene> scenes;
  Findings warnings;
};

struct BenchInputOptions {
  ReadOptions reading;                  ///< of logs
  std::uint64_t most_samples = 200000;  ///< of a simulated record
  std::size_t most_channels = 3;        ///< of a log: those with the most noise terms
};

/// A scene file: its scene. A model file: a signal. A log: it is characterized, and each channel's
/// model is a signal, as long as the log (at most `most_samples`). Throws what reading and
/// characterizing throw; Error(input) for a log or model with no noise to simulate, or a model
/// without a rate.
void add_bench_input(const std::string& path,
                     const BenchInputOptions& options,
                     BenchInputs& inputs,
                     Progress& progress = no_progress());

}  // namespace libchar

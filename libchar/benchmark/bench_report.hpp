#pragma once
// All that a run of benchmarks found.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/benchmark/characterization_bench.hpp"
#include "libchar/benchmark/design_bench.hpp"
#include "libchar/benchmark/fusion_bench.hpp"
#include "libchar/benchmark/scaling_bench.hpp"
#include "libchar/benchmark/stress_bench.hpp"
#include "libchar/benchmark/turns.hpp"

namespace libchar {

struct BenchReport {
  std::vector<std::string> command;  ///< as typed; set by the caller
  bool quick = false;
  std::uint64_t seed = 1;
  Machine machine;
  std::vector<CharacterizationBench> characterization;
  std::optional<FusionBench> fusion;
  std::optional<ScalingBench> scaling;
  std::optional<DesignBench> design;
  std::optional<StressBench> stress;
};

}  // namespace libchar

#pragma once
// bench.json: what a run of benchmarks writes, and what a later run is held against.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/benchmark/characterization_bench.hpp"
#include "libchar/benchmark/design_bench.hpp"
#include "libchar/benchmark/fusion_bench.hpp"
#include "libchar/benchmark/scaling_bench.hpp"
#include "libchar/benchmark/stress_bench.hpp"
#include "libchar/benchmark/turns.hpp"
#include "libchar/core/document/fields.hpp"

namespace libchar {

/// All that a run of benchmarks found.
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

const Fields<BenchReport>& bench_fields();

/// Throws Error(input) for another document, with its place where something in it is wrong.
BenchReport parse_bench_report(std::string_view text, const std::string& path);

}  // namespace libchar

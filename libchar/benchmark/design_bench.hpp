#pragma once
// Questions before buying and before recording: how many of which sensor reach an error, and how
// long a record must be to know a coefficient. From the bounds, checked by simulation.

#include <optional>
#include <string>
#include <vector>

#include "libchar/benchmark/characterization_bench.hpp"

namespace libchar {

struct DesignOptions {
  /// of the Allan deviation at `tau_s` of the fused sensors, in the models' unit; none: that question is not asked
  std::optional<double> target;
  double tau_s = 1;
  double share = 0.1;  ///< a coefficient is known to this share of it (one standard deviation)
  std::size_t records = 40;  ///< of each check
  std::uint64_t seed = 1;
  double most_samples =
      4e6;  ///< of one simulated record over all its sensors; what needs more is not checked
};

/// Equal sensors whose weighted mean reaches the target.
struct SensorsNeeded {
  std::string model;
  double single = 0;  ///< Allan deviation of one at tau
  std::uint64_t sensors = 0;
  double predicted = 0;  ///< of so many
  Figure simulated;      ///< of so many, root mean square over the records; no count: not checked
};

/// A record from which a method can know a coefficient so well.
struct RecordNeeded {
  std::string model;
  Term term = Term::white;
  std::optional<double> seconds;  ///< none: no record is long enough
  double samples = 0;
  Figure simulated;  ///< relative RMSE of the likelihood, terms given; no count: not checked
};

struct DesignBench {
  DesignOptions options;
  std::vector<SensorsNeeded> sensors;
  /// all of the given models together, one of each, weighted: its deviation; none: fewer than two, or no target
  std::optional<double> one_of_each;
  std::vector<RecordNeeded> records;
};

/// Throws Error(usage) for an averaging time below a sample's, or models of several units or rates
/// where a target is asked for.
DesignBench bench_design(const std::vector<BenchSignal>& models,
                         const DesignOptions& options,
                         Progress& progress = no_progress());

}  // namespace libchar

#pragma once
// Every way to get noise coefficients from a record, on simulated records whose coefficients are
// known: error over what is possible at all, coverage of stated intervals, time and memory.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/benchmark/figure.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/process/heap_meter.hpp"
#include "libchar/core/process/progress.hpp"
#include "libchar/model/sensor_model.hpp"

namespace libchar {

/// What the records are simulated from.
struct BenchSignal {
  std::string name;
  SensorModel model;  ///< its noise and its resolution; scale factor, bias and faults are left out
  double rate_hz = 0;
  std::uint64_t samples = 0;
};

/// Built in: the regimes that records are in, each with so many samples.
std::vector<BenchSignal> bench_signals(std::uint64_t samples);

struct CharacterizationBenchOptions {
  std::size_t records = 40;
  std::uint64_t seed = 1;
  std::vector<std::string> methods;  ///< empty: all
};

/// How well a method gets one coefficient that is in the records.
struct TermAccuracy {
  Term term = Term::white;
  double truth = 0;
  double bound = 0;  ///< Cramer-Rao: the least standard deviation that an unbiased method can have
  Figure error;      ///< RMSE over that bound; not detected counts as zero
  Figure coverage;   ///< of the stated 95 % intervals; no count: it states none
  double bias = 0;   ///< mean error over the bound
};

struct EstimatorAccuracy {
  std::string name, what;
  bool is_ours = true;
  bool told = false;  ///< which terms are in the records
  std::vector<TermAccuracy> terms;
  /// geometric mean of RMSE over bound, of the terms that a record can tell: whose bound is below half of them
  double error = 0;
  /// records in which it states a coefficient that is not in them; no count: it was given the terms, or all exist
  Figure false_terms;
  Figure ns_per_sample;
  Figure
      time_ratio;  ///< over the first method's on the same record: what load falls on alike is not in it
  std::optional<double> bytes_per_sample;  ///< of heap apart from the record
  /// detail/pareto.hpp; methods given the terms do not count against the others
  double front_gap = 0;
};

struct CharacterizationBench {
  BenchSignal signal;
  std::uint64_t seed = 1;
  std::uint64_t records = 0;
  std::vector<EstimatorAccuracy> methods;
  std::vector<std::string> notes;
};

/// Records are simulated one after the other, and each is given to every method in turn. Throws
/// Error(usage) for a method that is not known, Error(input) for a model without white noise,
/// flicker or walk.
CharacterizationBench bench_characterization(const BenchSignal& signal,
                                             const CharacterizationBenchOptions& options,
                                             Progress& progress = no_progress(),
                                             HeapMeter* heap = nullptr);

}  // namespace libchar

#pragma once
// A run of benchmarks against an older one: what is better or worse beyond both intervals.

#include <string>
#include <vector>

#include "libchar/benchmark/bench_document.hpp"
#include "libchar/core/document/json.hpp"

namespace libchar {

struct BenchChange {
  std::string what;  ///< "noise coefficients, white noise alone: sensorchar, ns a sample"
  bool is_time = false;
  Figure was, now;
  double ratio = 1;       ///< now over was
  bool resolved = false;  ///< the intervals do not meet
};

struct BenchChanges {
  std::vector<BenchChange> figures;  ///< that are in both
  bool same_machine = false;         ///< processor and their number
  std::vector<std::string> missing;  ///< that are in the older one only
  /// Worse and resolved, by more than `tolerance` of it: errors always, times on the same machine only and by three of it.
  std::vector<BenchChange> worse(double tolerance) const;
};

/// Throws Error(input) for an older one of other records and runs: its figures would be of something else.
BenchChanges bench_changes(const BenchReport& was, const BenchReport& now, const std::string& file);

std::string changes_text(const BenchChanges& changes, double tolerance);
Json changes_json(const BenchChanges& changes, double tolerance);

}  // namespace libchar

#pragma once
// report.json of a replay, read back: what a comparison needs of it (docs/replay.md).

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libchar/core/numeric/interval.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {

/// What one report says of one algorithm. NaN: the report has no value.
struct AlgorithmSummary {
  std::string label, name;
  bool ran = false;
  std::string why;     ///< why it did not run
  bool bound = false;  ///< it looked at the reference of the run itself
  double rmse = 0;     ///< leave-one-out RMS without a reference
  Interval rmse_ci95;
  double regret = 0;  ///< RMSE / optimum - 1
  double ns_per_sample = 0;
  double peak_bytes = 0;
  std::vector<std::pair<std::string, double>> options;
};

struct SensorSummary {
  std::string name, unit;
  double rmse = 0;  ///< of the sensor itself; NaN without a reference
  std::vector<double> h;
  std::optional<double> noise_variance;  ///< what algorithms were told
};

struct InputSummary {
  std::string name, unit;
};

/// A recording or reference that was read.
struct FileSummary {
  std::string path, sha256;  ///< `sha256` empty: not known
};

struct FaultSummary {
  std::string sensor, kind;
  double value = 0, from_s = 0, to_s = 0;  ///< NaN: none
  bool operator==(const FaultSummary&) const = default;
};

struct ReplaySummary {
  std::string file;     ///< of the report
  std::string program;  ///< version of the program that wrote it
  std::string scene_name, scene_file;
  bool simulated = false;
  std::uint64_t seed = 0;  ///< of a simulation
  std::string identity;    ///< of a simulation: hash of all that was simulated
  std::vector<FileSummary> files;
  double rate_hz = 0;
  std::uint64_t instants = 0;
  std::optional<TimeWindow> learning;
  TimeWindow evaluation;
  bool has_reference = false;
  std::string reference_use;
  double lag_s = 0;
  bool lag_estimated = false;
  std::vector<InputSummary> inputs;
  std::vector<SensorSummary> sensors;
  std::vector<FaultSummary> faults;
  std::string best;  ///< label; empty: none
  std::vector<AlgorithmSummary> algorithms;

  const AlgorithmSummary* find(std::string_view label) const;
};

/// Reads report.json; of a folder, the report.json in it. Throws Error(input) with file, line,
/// column and key.
ReplaySummary read_replay_report(const std::string& path);

/// The same from text that stands for a file at `path`.
ReplaySummary parse_replay_report(std::string_view text, const std::string& path);

}  // namespace libchar

#pragma once
// report.json of a replay: what replay writes, and what compare, plot and report read back (docs/replay.md).

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libchar/core/not_known.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/replay/replay_result.hpp"
#include "libchar/replay/view/replay_view.hpp"

namespace libchar {

struct ReplayReport : ReplayFacts {
  struct SceneOf {
    std::string name, file;
    bool simulated = false;
    std::uint64_t seed = 0;  ///< of a simulation
    std::string identity;    ///< of a simulation: hash of all that was simulated
  };
  struct Reference {
    std::string use;
    std::vector<std::string> channels;
    bool mean = false;
    double lag_s = 0;
    bool lag_estimated = false;
    double offset = 0;
    bool offset_estimated = false;
    Interval offset_ci95;  ///< of an estimated one, and the window it was found in
    TimeWindow offset_window;
    bool offset_drifts = false;
  };
  /// That the scene knows, or that an algorithm found.
  struct Fault {
    std::string sensor, kind;
    double value = kNone, from_s = 0;
    double to_s = std::numeric_limits<double>::infinity();
    /// {sensor, kind, from_s, to_s}
    static const Fields<Fault>& found_fields();
  };
  struct Term {
    double value = 0, standard_error = 0;
  };
  /// What was learnt of a sensor, and what its error is made of.
  struct Sensor {
    std::string sensor;
    bool aligned = false;
    Term delay_s, bias, gain;
    std::vector<Term> cross;
    fusion::ChannelLimits limits;
    fusion::ChannelBudget budget;
  };
  struct Alignment : AlignmentResult {
    std::vector<Sensor> sensors, budgeted_sensors;
  };
  /// The run, or a short stretch of it with every instant. Tracks have `time_s` in common.
  struct Stretch : RunStretch {
    std::vector<double> time_s;
    std::string method, sensor_name;  ///< of the run: whose; "": none
    std::string label;                ///< of a short stretch
    double from_s = 0, to_s = 0;
    std::vector<Stretch> close_ups;
  };
  /// `rmse` and `rmse_ci95` are the predictive ones without a reference. NaN: the report has no value.
  struct Algorithm : AlgorithmResult {
    Algorithm();
    explicit Algorithm(const AlgorithmResult& result) : AlgorithmResult(result) {}
    std::string name, title, source, complexity, learning_complexity;
    std::vector<std::string> needs;
    bool learns = false;  ///< from a reference
    bool accepts_missing = false;
    std::vector<Fault> found;
    std::vector<double> out_share;  ///< AlgorithmView
    std::vector<std::pair<std::string, double>> options;
    bool on_time_front = false, on_memory_front = false;
    static const Fields<Algorithm>& fields();
    double bytes() const { return peak_bytes ? static_cast<double>(*peak_bytes) : kNone; }
  };

  std::string file;  ///< it was read from
  DocumentHead head;
  SceneOf scene;
  std::string verdict, verdict_with_costs;
  std::optional<Reference> reference;
  ScenePreparation preparation;
  std::optional<Alignment> alignment;
  std::vector<Fault> faults;
  std::string best, best_sensor;    ///< label, name; "": none
  std::vector<std::string> ranked;  ///< labels, best first
  std::vector<RunMark> marks;
  std::optional<Stretch> run;
  std::vector<Algorithm> algorithms;

  /// All but the head.
  static const Fields<ReplayReport>& fields();
  const Algorithm* find(std::string_view label) const;
  std::string scene_title() const { return scene.name.empty() ? scene.file : scene.name; }
  /// What `rmse` of an algorithm is called in a sentence.
  std::string_view score_words() const { return reference ? "RMSE" : "Leave-one-out RMS"; }
};

/// Reads report.json; of a folder, the report.json in it. Throws Error(input) with file, line, column and key.
ReplayReport read_replay_report(const std::string& path);

/// The same from text that stands for a file at `path`.
ReplayReport parse_replay_report(std::string_view text, const std::string& path);
ReplayReport parse_replay_report(const Document& document, const std::string& path);

}  // namespace libchar

#pragma once
// A replay as its reports show it, computed once: the first, the fronts, who was skipped and why, and in which
// sentences, tracks short enough for a page. HTML, JSON, Markdown and terminal only print it.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/replay/replay_result.hpp"
#include "libchar/replay/view/ranking.hpp"

namespace libchar {

struct AlgorithmView {
  const AlgorithmResult* result = nullptr;
  bool best = false;    ///< of the methods
  bool learns = false;  ///< from a reference
  bool on_time_front = false, on_memory_front = false;
  std::vector<std::string> needs;           ///< of a scene, a phrase each
  std::string settings;                     ///< options that differ from the standard, "gamma = 0.99"
  Timeline weight_track, variance_track;    ///< thinned to what a page can hold
  std::vector<const FaultAnswer*> answers;  ///< one a known fault; null: it does not watch
  std::size_t alarms_without_fault = 0;     ///< raised where the scene knows of none
  /// of the run that each sensor was out (re-weighted ones are in use); empty: it does not watch
  std::vector<double> out_share;
  double core_share = 0;  ///< of one core, at the rate of the recording; NaN: not measured
};

/// A stretch of the run that plots over time mark, clipped to it.
struct RunMark {
  std::string kind;    ///< "fault", "found" (and not declared), "warm-up", "learning"
  std::string label;   ///< "gyro2: scale 0.8"
  std::string sensor;  ///< of a fault, declared or found
  double from_s = 0, to_s = 0;
};

/// The run over time: the reference, the best method, the best single sensor.
struct RunView {
  std::string method, sensor;          ///< whose; "": none
  Timeline deviations;                 ///< of sensors from their median, thinned to what a page can hold
  std::vector<std::string> close_ups;  ///< names of the result's close-ups
  std::vector<RunMark> marks;
};

/// One true input, with what there is to draw of it.
struct InputView {
  const InputResult* result = nullptr;
  std::vector<const AlgorithmView*> ranked;  ///< by the error of this input, best first
  bool has_window_rms = false, has_allan = false;
};

/// A row of numbers of the run, one per sensor; NaN: none.
struct FinalRow {
  std::string label;  ///< "minque: weights of x", "minque: standard deviations"
  std::vector<double> values;
  double distance = 0;  ///< from the optimum; NaN: not known
};

/// What an algorithm remarks on its run.
struct AlgorithmRemark {
  std::string label;  ///< of the algorithm; empty where the message names it
  std::string message;
  std::uint64_t count = 1;
};

/// Which figures have something to show.
struct ReplayFigures {
  bool error_over_time = false;    ///< cost: ns per sample
  bool error_over_memory = false;  ///< cost: peak bytes
  bool weights = false, variances = false, faults = false, sensors = false;
  bool detection = false;     ///< delays until known faults are found, over the rate of false alarms
  bool ranking = false;       ///< a method has a score
  bool run = false;           ///< an estimate over time
  bool deviations = false;    ///< of the sensors from their median
  bool availability = false;  ///< of a method below 0.999: worth a column
  bool bias = false;          ///< more than half of a method's RMSE: offsets decide
  /// run time can decide between methods: one of them takes more than `kCoreThatMatters` of a core
  bool time_matters = false;
};

/// Of one core at the recording's rate; below it run time decides nothing.
inline constexpr double kCoreThatMatters = 1e-3;

/// Points into the result that it is a view of, which must live as long.
struct ReplayView {
  const ReplayResult* result = nullptr;
  std::string title;                           ///< the scene's name, else its file
  std::string optimum;                         ///< what it is of: "fixed weights", "tilt filters"
  std::vector<std::string> verdict;            ///< sentences, with what was measured
  std::vector<std::string> steady_verdict;     ///< without: the same in every run
  std::vector<std::string> shown_verdict;      ///< of both, as shown
  double duration_s = 0, end_s = 0;            ///< of the run
  std::vector<AlgorithmView> algorithms;       ///< all, in the order of the table
  std::vector<const AlgorithmView*> ranked;    ///< those that ran, best first, bounds among them
  std::vector<const AlgorithmView*> watching;  ///< those that take sensors out
  std::vector<SkippedAlgorithms> skipped;
  std::vector<InputView> inputs;
  RunView run;
  std::vector<std::optional<double>> noise_sd;  ///< of a sensor's sample, as given to algorithms
  std::vector<FinalRow> final_rows;
  std::vector<AlgorithmRemark> remarks;
  Findings warnings;  ///< of the replay and of its logs
  ReplayFigures figures;
  std::string simulation_identity;  ///< SHA-256 of all that was simulated; empty: a recording

  ReplayView() = default;
  ReplayView(const ReplayView&) = delete;
  ReplayView& operator=(const ReplayView&) = delete;
  ReplayView(ReplayView&&) = default;
  ReplayView& operator=(ReplayView&&) = default;
};

ReplayView replay_view(const ReplayResult& result);
ReplayView replay_view(ReplayResult&&) = delete;

}  // namespace libchar

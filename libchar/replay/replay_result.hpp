#pragma once
// What a replay found: everything that its reports show.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/document/entry.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/fusion/alignment.hpp"
#include "libchar/fusion/description.hpp"
#include "libchar/fusion/error_budget.hpp"
#include "libchar/fusion/options.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/replay/common_errors.hpp"
#include "libchar/replay/error_meter.hpp"
#include "libchar/replay/fault_answers.hpp"
#include "libchar/replay/fusion_file.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {

// Values over time, thinned until a plot can show them.

/// Values over time, thinned to bins: the smallest and the largest in each. Empty: nothing to show.
struct Timeline {
  std::vector<double> time_s;                  ///< middle of each bin, seconds from the recording's first sample
  std::vector<std::vector<double>> low, high;  ///< [series][bin]; NaN: no value in this bin
  bool empty() const { return time_s.empty(); }
};

// What a run looks like: truth, best method and best single sensor over time.

/// One true input over the run; a series each, empty where there is no reference.
struct InputTracks {
  Timeline reference, estimate, error;
};

/// A stretch of a run, thinned to its smallest and largest values: the truth, what one method made
/// of the samples, one sensor.
struct RunStretch {
  std::vector<InputTracks> inputs;  ///< empty: nothing ran
  Timeline sensor, sensor_error;    ///< of `best_sensor`, divided by its h: in the input's unit
  /// without a reference: of each sensor, divided by its h, from the median of all; a series a
  /// sensor. Empty where sensors do not see one input in one unit.
  Timeline deviations;
};

/// A short stretch, every instant of it.
struct CloseUp {
  std::optional<std::size_t> fault;  ///< around the start of this one of ReplayResult::faults
  double from_s = 0, to_s = 0;
  RunStretch run;
};

/// The picture of a run: the best method next to the best single sensor.
struct RunTracks {
  std::optional<std::size_t> algorithm;  ///< whose estimate: the best, else the first in the order
  RunStretch whole;
  std::vector<CloseUp> close_ups;  ///< rising; empty where `whole` has every instant
};

// What a replay found about the sensors themselves, before any fusion.

struct SensorResult {
  std::string name, unit;
  ErrorScore error;                      ///< of y - h x; NaN without a reference
  std::optional<double> noise_variance;  ///< as given to algorithms
  std::string noise_source;              ///< "model", "rest", "scene", ""
  double offset = 0;                     ///< subtracted (mean over the rest)
  double missing = 0;                    ///< share of the instants of the run
  bool constant = false;                 ///< never changed during the run
  std::string copy_of;                   ///< the earlier sensor that it repeats, sample by sample
  std::vector<double> h;
};

/// What was learnt of the sensors before fusion, and what their errors are made of on the run.
struct AlignmentResult {
  /// A term of the alignment that was tried: errors on halves of the learning window, each taught by the other.
  struct Trial {
    std::string term;    ///< "bias", "delay", "delay, cubic", "gain", "misalignment"; "": as recorded
    double rmse = 0;     ///< of weights learnt on the other half, with it and with the terms that were kept before
    double of_mean = 0;  ///< of the plain mean
    bool kept = false;
  };

  fusion::Alignment learnt;
  TimeWindow window;          ///< it was learnt on
  bool by_reference = false;  ///< by the reference; else by the sensors' mean
  bool applied = false;
  bool overlaps = false;  ///< learnt on a part of what is judged
  fusion::ErrorBudget budget;
  std::vector<std::size_t> budgeted;  ///< sensors in the budget
  std::vector<Trial> trials;          ///< where the terms were chosen; the first is without any
};

/// By how much the reference reads more than the sensors, as it was found; in the unit of the input.
struct FoundOffset {
  double value = 0;
  Interval ci95;             ///< NaN: too few instants
  TimeWindow window;         ///< it was found in
  bool in_learning = false;  ///< the learning window; else what is scored
  bool drifts = false;       ///< within that window
};

struct InputResult {
  std::string name, unit;
  double optimum_rmse = 0;  ///< of the best linear unbiased weights of the run; NaN: no reference
};

// What one algorithm did on a run: errors, costs, weights, the faults that it found.

/// One true input as one algorithm estimated it.
struct InputScore {
  std::string name, unit;  ///< of the input, in a report
  ErrorScore error;
  double optimum_ratio = 0;  ///< RMSE / optimum RMSE of this input; NaN: unknown
  AllanCurve allan;          ///< overlapping Allan deviation of the error; no points: not computed
  Timeline window_rms;       ///< one series: RMS of the error in a window centred on each bin [RV]
};

/// A difference between errors that is not worth a choice.
inline constexpr double kPracticalTolerance = 0.01;

/// Scores that need no reference, named as such: errors that all sensors share are not seen.
struct BlindScore {
  double leave_one_out_rms = 0;       ///< RMS over all sensors of (fused from the others) - (the sensor)
  std::vector<double> leave_one_out;  ///< the same for each sensor; NaN: could not run
  double split_rms = 0;               ///< RMS of half the difference of two parts of the array; NaN: could not run
  Interval leave_one_out_ci95;
  double share = 1;  ///< of the evaluation that was scored; below 1 leave-one-out costs more than its budget
  /// geometric mean over the sensors of their leave-one-out RMS: what methods are ranked by
  double predictive_rms = 0;
  Interval predictive_ci95;
  double offset_share = 0;  ///< of leave_one_out_rms squared, that is in the sensors' mean differences from the others
};

struct AlgorithmResult : detail::FaultsFound {
  std::string label;  ///< the name, with its options when one algorithm runs twice
  const fusion::Description* description = nullptr;
  fusion::Settings settings = fusion::Settings();
  bool ran = false;
  std::string why;     ///< why it did not run, without its name
  bool bound = false;  ///< it looked at the reference of the run itself

  std::vector<InputScore> inputs;  ///< empty without a reference
  std::optional<BlindScore> blind;
  double rmse = 0;  ///< of the first input, or the predictive one without a reference: what tables sort
                    ///< by; NaN: none
  Interval rmse_ci95;
  double regret = 0;                      ///< root mean square over the inputs of RMSE / optimum, minus 1; NaN: unknown
  std::optional<Interval> ratio_to_best;  ///< 95 % interval of RMSE / RMSE of the best method
                                          ///< (bounds apart); none: it is the best
  bool as_good_as_best =
      false;  ///< that interval (corrected for the number of methods) holds 1, or the difference is below one per cent
  double availability = 0;

  double ns_per_sample = 0;                 ///< median over interleaved blocks; NaN: too short to measure
  double learning_s = 0;                    ///< making it and its learning, CPU of one core
  std::optional<std::uint64_t> peak_bytes;  ///< of heap, over learning and run; none: not measured

  /// of each input, one per sensor: medians over the run, of several inputs those at its end; empty: not known
  std::vector<std::vector<double>> weights;
  std::vector<double> variances;  ///< medians over the run, one per sensor; empty: not known
  double weight_distance = 0;     ///< RMS over time of |w - optimal weights| (Euclid), one input; NaN: unknown
  double variance_error = 0;      ///< RMS over sensors and time of ln(variance / true error variance); NaN: unknown
  Timeline weight_track;          ///< one series per sensor; empty when the weights are constant
  Timeline variance_track;
  Findings remarks;
};

/// Work done, to prove what was skipped.
struct ReplayWork {
  std::uint64_t passes = 0;       ///< over the recording or simulation
  std::uint64_t learnt = 0;       ///< instants given to learning, summed over algorithms
  std::uint64_t steps = 0;        ///< instants fused, summed over algorithms
  std::uint64_t blind_steps = 0;  ///< the same for leave-one-out and split arrays
};

/// Performance of the fault detector on a run with known faults, at one false alarm of the array per
/// `false_alarm_s`.
struct DetectionAt {
  double false_alarm_s = 0;
  std::vector<FaultAnswer> answers;
  std::uint64_t alarms_without_fault = 0;
};

/// What a result and its report say alike.
struct ReplayFacts : detail::CommonErrors {
  std::vector<std::string> plan;  ///< sentences: what was read, learnt, run, skipped and why
  double rate_hz = 0;             ///< of the instants that are fused
  std::uint64_t instants = 0;     ///< of the run
  double start_s = 0;             ///< of the run, seconds from the recording's first sample
  double scored_from_s = 0;       ///< after the warm-up
  std::optional<TimeWindow> learning;
  TimeWindow evaluation;
  double window_s = 0;  ///< of the window RMS
  std::vector<SensorResult> sensors;
  std::vector<InputResult> inputs;
  /// by `false_alarm_s`; empty: no fault is known, or no algorithm that runs has the detector
  std::vector<DetectionAt> detection;
  /// label of the best method in whose estimates several sensors have a part; "": none has a score
  std::string best_fusion;
  /// the 95 % interval of its RMSE over that of the best sensor; one input and a reference
  std::optional<Interval> best_over_sensor;
  /// without a reference, differences between the sensors' means are nearly all that is seen
  bool offsets_decide = false;
  /// the best method is not that of the smallest error but one that a failing sensor does not lead
  /// astray: without a reference it has no score, or offsets decide the scores
  bool chosen_as_robust = false;

  double end_s() const { return start_s + static_cast<double>(instants) / rate_hz; }
};

struct ReplayResult : ReplayFacts {
  Scene scene;
  std::vector<LogInfo> logs;         ///< the recording, the reference's own log; empty for a simulation
  std::vector<std::string> command;  ///< as typed; set by the caller
  std::vector<Entry> settings;       ///< effective ones, for provenance
  double lag_s = 0;                  ///< the sensors lag the reference by this
  bool lag_estimated = false;
  std::optional<FoundOffset> reference_offset;  ///< where the scene asked for it
  bool has_reference = false;
  std::string reference_use;  ///< "each instant", "mean over its intervals of 3600 s"…
  std::optional<AlignmentResult> alignment;
  std::vector<SensorFault> faults;          ///< that the scene knows, injected or simulated
  std::vector<AlgorithmResult> algorithms;  ///< in the order of the table
  std::optional<std::size_t> best;          ///< of the methods (no bounds) by `rmse`
  std::optional<std::size_t> best_sensor;   ///< of the smallest error; one input and a reference
  RunTracks tracks;
  LearntFusion learnt;  ///< of the array and of every algorithm that ran: what `fuse` applies
  Findings warnings;
  ReplayWork work;
  WorkDone counted{};  ///< all of it
  double seconds = 0;  ///< measured

  /// By its label; null: there is none.
  const AlgorithmResult* find(std::string_view label) const {
    for (const AlgorithmResult& a : algorithms)
      if (a.label == label) return &a;
    return nullptr;
  }
};

}  // namespace libchar

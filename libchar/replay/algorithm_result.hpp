#pragma once
// What one algorithm did on a run: errors, costs, weights, the faults that it found.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/fusion/description.hpp"
#include "libchar/fusion/options.hpp"
#include "libchar/replay/error_meter.hpp"
#include "libchar/replay/fault_answers.hpp"
#include "libchar/replay/timeline.hpp"

namespace libchar {

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
  double leave_one_out_rms = 0;  ///< RMS over all sensors of (fused from the others) - (the sensor)
  std::vector<double> leave_one_out;  ///< the same for each sensor; NaN: could not run
  double split_rms =
      0;  ///< RMS of half the difference of two parts of the array; NaN: could not run
  Interval leave_one_out_ci95;
  double share =
      1;  ///< of the evaluation that was scored; below 1 leave-one-out costs more than its budget
  /// geometric mean over the sensors of their leave-one-out RMS: what methods are ranked by
  double predictive_rms = 0;
  Interval predictive_ci95;
  double offset_share =
      0;  ///< of leave_one_out_rms squared, that is in the sensors' mean differences from the others
};

struct AlgorithmResult {
  std::string label;  ///< the name, with its options when one algorithm runs twice
  const fusion::Description* description = nullptr;
  fusion::Settings settings = fusion::Settings();
  bool ran = false;
  std::string why;     ///< why it did not run, a sentence
  bool bound = false;  ///< it looked at the reference of the run itself

  std::vector<InputScore> inputs;  ///< empty without a reference
  std::optional<BlindScore> blind;
  double rmse =
      0;  ///< of the first input, or the predictive one without a reference: what tables sort
          ///< by; NaN: none
  Interval rmse_ci95;
  double regret = 0;  ///< root mean square over the inputs of RMSE / optimum, minus 1; NaN: unknown
  std::optional<Interval> ratio_to_best;  ///< 95 % interval of RMSE / RMSE of the best method
                                          ///< (bounds apart); none: it is the best
  bool as_good_as_best =
      false;  ///< that interval (corrected for the number of methods) holds 1, or the difference is below one per cent
  double availability = 0;

  double ns_per_sample = 0;  ///< median over interleaved blocks; NaN: too short to measure
  double learning_s = 0;     ///< making it and its learning, CPU of one core
  std::optional<std::uint64_t> peak_bytes;  ///< of heap, over learning and run; none: not measured

  /// of each input, one per sensor: medians over the run, of several inputs those at its end; empty: not known
  std::vector<std::vector<double>> weights;
  std::vector<double> variances;  ///< medians over the run, one per sensor; empty: not known
  double weight_distance =
      0;  ///< RMS over time of |w - optimal weights| (Euclid), one input; NaN: unknown
  double variance_error =
      0;  ///< RMS over sensors and time of ln(variance / true error variance); NaN: unknown
  Timeline weight_track;  ///< a series a sensor; empty when the weights stand still
  Timeline variance_track;
  bool watches_faults = false;  ///< it takes sensors out; `faults` and `answers` mean something
  std::vector<FoundFault> faults;
  std::uint64_t faults_not_kept = 0;
  std::vector<FaultAnswer> answers;
  Findings remarks;
};

}  // namespace libchar

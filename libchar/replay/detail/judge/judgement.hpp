#pragma once
// What follows from the scores of all algorithms of one replay together.
//   regret          RMSE / RMSE of the best fixed weights learnt on the run, known faults left
//                   out, - 1
//   as good as best the 95 % interval of RMSE / RMSE of the best method holds 1
//   weight distance root mean square over time of |w - w of the best fixed weights|
//   variance error  root mean square over time and sensors of ln(variance / mean square error)

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "libchar/fusion/runner.hpp"
#include "libchar/replay/detail/algorithm_run.hpp"
#include "libchar/replay/detail/plan/plan.hpp"
#include "libchar/replay/error_meter.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {

// Which method is recommended: not simply the smallest number.

/// A method or a sensor that has a value at clearly fewer instants than others is not the best by that.
inline constexpr double kLeastAvailable = 0.9;

/// Several sensors have a part in its estimates; else it hands one of them on.
bool combines_sensors(const AlgorithmResult& algorithm);

/// Of the methods that ran (bounds apart), the one of the smallest error. Those within the practical tolerance of it
/// tie (without a reference, whose scores hold the noise of the sensor that is left out, those of equal score): a
/// mended form wins before the one as published, then the cheaper one by `costs` (declared, one an algorithm). A method
/// whose interval spans a decade is not chosen while there is another. `fusions`: only of those that combine sensors.
std::optional<std::size_t> choose_method(const ReplayResult& result, const std::vector<double>& costs,
                                         bool fusions = false);

/// Without scores: of the methods that ran, the highest of those that a failing sensor does not lead astray.
std::optional<std::size_t> choose_robust(const ReplayResult& result);

/// Optimum of each input, and from it the regrets. `optimum`: the bounds that ran. More than one input, or rows of H
/// that differ: from the sensors' own errors without known faults (`healthy_rms`), (H' R^-1 H)^-1.
void judge_optimum(ReplayResult& result, const std::vector<AlgorithmRun>& optimum,
                   const std::vector<double>& healthy_rms, const fusion::Array& array);

/// Distances over time; needs `sensors` of the result.
void judge_tracking(AlgorithmResult& algorithm, const AlgorithmRun& run, const std::vector<AlgorithmRun>& optimum,
                    const ReplayResult& result, const fusion::Array& array);

/// Which known faults were found, and when.
void answer_faults(AlgorithmResult& algorithm, const ReplayResult& result);

/// The best method and who cannot be told from it. `meters`: the errors that `rmse` came from, for
/// each algorithm, empty where there are none.
void judge_best(ReplayResult& result, const std::vector<Meters>& meters, const std::vector<double>& costs,
                const ScoreOptions& scoring);

/// The best single sensor beside the best fusion: one input, a reference. `sensors`: of their errors, in order.
void judge_best_sensor(ReplayResult& result, const std::vector<Meters>& meters, const Meters& sensors,
                       const ScoreOptions& scoring);

/// The fault detector beside itself: the same samples with one threshold after another. What a higher
/// rate of false alarms buys in delay, on a run whose faults are known.
class DetectionSweep {
 public:
  /// Does nothing where no algorithm of the plan has the detector, or no fault is known.
  DetectionSweep(const ReplayPlan& plan, const std::vector<SensorFault>& known);
  /// All sensors of the scene.
  void push(const Eigen::MatrixXd& samples);
  std::vector<DetectionAt> result(double start_s, double rate_hz, double end_s) const;

 private:
  struct Setting {
    double false_alarm_s = 0;
    std::unique_ptr<fusion::Runner> watched;  ///< the cheapest algorithm with the detector in front of it
  };
  std::vector<SensorFault> known_;
  std::vector<std::size_t> sensors_;  // of the detectors' channels
  Eigen::Index inputs_;
  std::vector<Setting> settings_;
  Eigen::MatrixXd x_, variance_;  // of no interest
};

// Scores of methods that ran on a part of the evaluation only, beside those of methods that ran on
// all of it: what they are compared by is what both saw.

/// Leave-one-out was cut short.
bool on_stretches(const AlgorithmResult& a);

/// Errors of two methods at the instants that both have.
struct CommonMeters {
  std::vector<ErrorMeter> copies;
  Meters a, b;
};
CommonMeters in_common(const Meters& a, const Meters& b);

/// The predictive RMS of each method that ran on stretches, for the whole evaluation: its ratio to the first method
/// that ran on all of it, from the instants in common, times that method's RMS. Both uncertainties are in its interval.
void extend_partial_scores(ReplayResult& result, const std::vector<Meters>& meters, const ScoreOptions& scoring);

}  // namespace libchar

#pragma once
// The fault detector beside itself: the same samples with one threshold after another. What a higher
// rate of false alarms buys in delay, on a run whose faults are known.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "libchar/fusion/runner.hpp"
#include "libchar/replay/detail/plan/plan.hpp"
#include "libchar/replay/fault_answers.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {

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
    std::unique_ptr<fusion::Runner>
        watched;  ///< the cheapest algorithm with the detector in front of it
  };
  std::vector<SensorFault> known_;
  std::vector<std::size_t> sensors_;  // of the detectors' channels
  Eigen::Index inputs_;
  std::vector<Setting> settings_;
  Eigen::MatrixXd x_, variance_;  // of no interest
};

}  // namespace libchar

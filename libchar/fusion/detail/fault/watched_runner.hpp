#pragma once
// The fault detector (fault_detector.hpp) in front of any estimate that goes on without a missing
// sample: what a sensor says while it is out is missing for the estimate. Weights that are fixed
// know nothing of noise: a sensor whose variance is twice what it was is out as well (with weight w
// of n alike it would cost more than it brings from (n + 1)/(n - 1) times on).

#include <array>
#include <memory>
#include <optional>

#include "libchar/fusion/detail/fault/fault_detector.hpp"
#include "libchar/fusion/runner.hpp"

namespace libchar::fusion {

/// What the algorithms that can be watched have behind their own options.
inline constexpr std::array kWatchOptions{
    Option{"fault_detection",
           "",
           0,
           0,
           1,
           "1: sensors that fail are left out, found by cumulative sums as minque does; 0: all "
           "are used",
           true},
    Option{"false_alarm_s",
           "s",
           1e5,
           1,
           1e15,
           "mean time between two false alarms of the array (without a rate: per 2e7 samples)"},
    Option{"recovery_window",
           "samples",
           0,
           0,
           1e9,
           "own samples that must agree with the others before a channel comes in again (0: 200, "
           "or those of 2 s "
           "where they are fewer)",
           true}};

class WatchedRunner final : public Runner {
 public:
  /// The settings have `kWatchOptions`.
  WatchedRunner(const Array& array, const Settings& settings, std::unique_ptr<Runner> watched);

  const Description& description() const override { return watched_->description(); }
  void learn(const Block& samples, const Block& truth) override { watched_->learn(samples, truth); }
  void look(const Block& samples) override;
  void finish_learning() override { watched_->finish_learning(); }
  bool exchange(LearntExchange& with) override { return watched_->exchange(with); }
  void run(const Block& samples, BlockOut x, BlockOut variance) override;
  std::optional<Eigen::MatrixXd> weights() const override { return watched_->weights(); }
  std::optional<Eigen::VectorXd> variances() const override { return watched_->variances(); }
  const FaultLog* faults() const override { return detector_ ? &detector_->log() : &none_; }
  void remarks(Findings& warnings) const override;

 private:
  /// What is left of a block of samples, at most `kWatchedAtOnce` instants.
  void leave_out(FaultDetector& detector, const Block& samples);

  Array array_;
  FaultDetectorOptions options_;
  std::unique_ptr<Runner> watched_;
  std::optional<FaultDetector> detector_;  // none: too few sensors to tell which of them fails
  std::optional<FaultDetector> ahead_;     // of the run while it is looked at
  FaultLog none_;
  Eigen::MatrixXd used_;
};

}  // namespace libchar::fusion

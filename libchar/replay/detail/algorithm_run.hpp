#pragma once
// One algorithm on its way through a replay: it learns, runs block by block, is timed and scored.

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/fusion/runner.hpp"
#include "libchar/replay/detail/coverage_meter.hpp"
#include "libchar/replay/detail/plan/plan.hpp"
#include "libchar/replay/detail/sensor_doubt.hpp"
#include "libchar/replay/fusion_file.hpp"

namespace libchar {

/// Weights and variances of a run: medians over time, since at its last instant sensors may be missing.
/// Notes are taken behind instants that do not depend on the blocks in which the run is read.
class RunMedians {
 public:
  /// Instants from `done` on until the next note is due.
  std::int64_t until_next(std::int64_t done) const { return every_ - done % every_; }
  void set_length(std::int64_t instants);
  /// After an instant whose notes are due.
  void note(const std::optional<Eigen::MatrixXd>& weights, const std::optional<Eigen::VectorXd>& variances);
  /// In the place of the values at the end; untouched where nothing was noted. Weights keep the sum that they have at
  /// most instants.
  void take(std::vector<double>& weights, std::vector<double>& variances) const;

 private:
  std::int64_t every_ = 1;
  std::vector<std::vector<double>> weights_, variances_;  // a series a sensor
};

/// What all runs of one replay share.
struct RunFrame {
  const fusion::Array* array = nullptr;
  const std::vector<Eigen::Index>* live = nullptr;  ///< the sensors it is given; none: all
  HeapMeter* heap = nullptr;
  double rate_hz = 0, start_s = 0;  ///< of the run
  double scored_from_s = 0;         ///< after the warm-up
  std::int64_t instants = 0;        ///< of the run
  double output_scale = 1;
  bool tilt = false;  ///< errors are taken the short way round
  bool allan = false;
  bool tracks = false;  ///< weights and variances over time are wanted
};

/// The result of an algorithm that does not run.
AlgorithmResult not_run(const PlannedAlgorithm& planned, const std::string& why);

/// A median of fewer blocks is no median: short recordings are run again for the clock…
inline constexpr std::size_t kLeastTimed = 31;
/// …unless an algorithm is slow: so long a time is known well enough.
inline constexpr double kEnoughTimed_s = 0.25;

class AlgorithmRun {
 public:
  AlgorithmRun(const PlannedAlgorithm& planned, const RunFrame& frame);
  const PlannedAlgorithm& planned() const { return *planned_; }
  /// Empty: it is running. Else why it cannot (what it said while learning).
  const std::string& failure() const { return failure_; }
  bool alive() const { return runner_ != nullptr; }

  void learn(const Eigen::MatrixXd& samples, const Eigen::MatrixXd& truth);
  /// The run itself, for those that look ahead.
  void look(const Eigen::MatrixXd& samples);
  void finish_learning();
  /// What it learnt, for the file that applies it.
  LearntAlgorithm hand_out() const;
  void run(const Eigen::MatrixXd& samples);
  /// After `run`: errors of its estimates. `first` instant of the run; the first `skip` of the block are warm-up.
  void score(std::int64_t first, const Eigen::MatrixXd& truth, Eigen::Index skip);
  /// Once more on a block, for the clock alone: its state is not looked at afterwards.
  void repeat(const Eigen::MatrixXd& samples);

  /// r x m estimates of the last block, in output units.
  const Eigen::MatrixXd& estimates() const { return x_; }
  const std::vector<ErrorMeter>& meters() const { return meters_; }
  bool timed_enough() const { return !alive() || ns_.size() >= kLeastTimed || timed_s_ >= kEnoughTimed_s; }
  /// Of an instant, what was done beforehand on the run itself counted in; NaN before the first block.
  double median_ns() const;
  /// Everything that is known without the others: scores, tracks, faults, cost.
  AlgorithmResult result(const ScoreOptions& options, double window_s) const;
  /// Weights of one input at the end of each block.
  const std::vector<std::vector<double>>& weight_samples() const { return weight_samples_; }
  const std::vector<std::vector<double>>& variance_samples() const { return variance_samples_; }
  /// A row a sensor of the scene; zero (variances: NaN) for those it was not given.
  std::optional<Eigen::MatrixXd> weights() const;
  std::optional<Eigen::VectorXd> variances() const;
  /// Of each input; empty: not known of all of them.
  std::vector<double> sd_factor() const;
  const detail::UsualEstimates& usual() const { return seen_.usual; }
  std::uint64_t learnt() const { return learnt_; }
  std::uint64_t steps() const { return steps_; }

 private:
  template <class Work>
  void guarded(const Work& work);
  template <class Work>
  double accounted(const Work& work);  // wall seconds
  bool some_left_out() const { return frame_->live != nullptr && !frame_->live->empty(); }
  void timed_run(const Eigen::MatrixXd& samples, bool noted);
  void note_tracks(double time_s);
  void thin_notes();
  std::vector<FoundFault> faults() const;

  const PlannedAlgorithm* planned_;
  const RunFrame* frame_;
  std::unique_ptr<fusion::Runner> runner_;
  std::string failure_;
  Eigen::MatrixXd x_, variance_;
  std::vector<double> error_;
  std::vector<ErrorMeter> meters_;
  std::vector<AllanPyramid> allan_;
  std::vector<double> ns_;
  std::size_t blocks_ = 0, stride_ = 1;  // one block of so many is noted
  double timed_s_ = 0;
  double ahead_s_ = 0;  // of looking at the run, for all its instants
  std::uint64_t looked_ = 0;
  RunMedians medians_;
  std::vector<double> track_times_;
  std::vector<std::vector<double>> weight_samples_, variance_samples_;
  double learning_s_ = 0;
  struct {
    double available = 0, scored = 0;
    std::vector<detail::CoverageMeter> coverage;  // of the stated deviation of each input
    detail::UsualEstimates usual;
  } seen_;
  struct {
    std::int64_t held = 0, peak = 0;
  } heap_;
  std::uint64_t learnt_ = 0, steps_ = 0;
};

}  // namespace libchar

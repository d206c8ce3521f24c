#pragma once
// Which sensors to believe, instant by instant, for any estimate that weighs them: a bank of cumulative
// sums (cusum_bank.hpp) on residuals against a slow baseline (fault_baseline.hpp), the largest
// consistent set on an alarm (fault_isolation.hpp), a watch on repeated values (repeat_watch.hpp).
//
//   alarm when a sum exceeds h = ln(c n T),  T samples between false alarms of the array
//
// (each sum exceeds h about e^-h / c times a sample; c is measured by fault_bench.) What then happens:
//
//   bias, gain, dead, stuck   out; in again when a window of own samples is consistent with the others
//   noise                     stays in; its variance is what the window says
//   saturated                 out where the others go beyond its end of the range
//   two sets explain it       none is thrown out; said
//   no set is consistent      the residuals are not what the noise explains: when that lasts, the detector
//                             stands down, lets all in and learns its baseline anew; said
//
// A baseline is frozen while evidence against its sensor gathers and while it is out. A missing sample is no
// fault, and each sensor counts its own samples.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/fusion/array.hpp"
#include "libchar/fusion/detail/fault/cusum_bank.hpp"
#include "libchar/fusion/detail/fault/fault_baseline.hpp"
#include "libchar/fusion/detail/fault/fault_isolation.hpp"
#include "libchar/fusion/detail/fault/recovery_window.hpp"
#include "libchar/fusion/detail/fault/repeat_watch.hpp"
#include "libchar/fusion/detail/variances/reweighted_matrix.hpp"
#include "libchar/fusion/detail/variances/reweighted_variances.hpp"
#include "libchar/fusion/fault_log.hpp"

namespace libchar::fusion {

struct FaultDetectorOptions {
  double false_alarm_s = 1e5;  ///< mean time between false alarms of the array
  /// own samples that must be consistent before a sensor is let in; 0: 200, or those of 2 s where
  /// they are fewer (64 at least)
  std::int64_t recovery = 0;
  std::int64_t learning = 1000;  ///< own samples before a sensor is judged
};

/// A variance that is to be taken for `ratio` times what it was.
struct VarianceChange {
  int channel = 0;
  double ratio = 1;
};

class FaultDetector {
 public:
  FaultDetector(const Array& array, const FaultDetectorOptions& options);

  /// Judges an instant, one value a channel, NaN = missing.
  void step(const double* y);
  bool out(std::size_t i) const { return out_[i] != Out::no; }
  int count_out() const { return count_out_; }
  /// Its variance over what it was, where it has become noisy; else 0.
  double noisy(std::size_t i) const { return noisy_[i]; }
  /// The last step has let a sensor in, taken it out or re-weighted it.
  bool set_changed() const { return set_changed_; }
  std::span<const VarianceChange> changes() const { return changes_; }
  const FaultLog& log() const { return log_; }
  void remarks(std::string_view algorithm, Findings& warnings) const;
  double threshold() const { return threshold_; }

 private:
  enum class Out : char { no, judged, stuck, saturated };
  static constexpr int kStart = 32;  // instants of the start
  static constexpr int kHalfStart = kStart / 2;
  static constexpr int kWindow = 512;  // instants that an alarm is judged by

  void start(const double* y);
  void begin();
  template <class Variances>
  void step_with(Variances& variances, const double* y);
  bool use(const double* y);
  template <class Variances>
  bool residuals(Variances& variances, const double* y);
  void note_window();
  template <class Variances>
  void slow_work(Variances& variances);
  void watch_repeats(const double* y);
  void repeat_state(std::size_t i);
  template <class Variances>
  void follow_out(Variances& variances, const double* y);
  template <class Variances>
  void meet_newcomers(Variances& variances, const double* y);
  void follow_noisy();
  void make_noisy(std::size_t i, double ratio);
  void change_variance(std::size_t i, double ratio);
  void take_out(std::size_t i, FaultRule rule);
  void let_in(std::size_t i);
  void sets_changed();
  // fault_judgement.cpp
  void judge();
  int change_point(std::size_t i) const;
  void gather_evidence(int window);
  void judge_noise(int window);
  void declare_faulty(std::size_t i);
  void noise_fault(std::size_t i, int window);
  bool is_dead(std::size_t i, int window) const;
  FaultRule kind(std::size_t i, int window) const;
  int least_healthy(FaultRule rule) const;
  void act(const Isolation& found, int window);
  void doubt(const Isolation& found);
  void misfit(int sensor);
  bool most_judged_together() const;
  void stand_down();
  double variance(std::size_t i) const {
    return general_ ? general_->variance(i) : scalar_.variance(i);
  }
  std::size_t at(int back, std::size_t i) const {
    return static_cast<std::size_t>((now_ + kWindow - back) % kWindow) * base_.padded + i;
  }

  FaultDetectorOptions options_;
  int inputs_;
  double rate_hz_;
  std::int64_t fault_free_;
  ReweightedVariances scalar_;
  std::optional<ReweightedMatrix> general_;
  FaultBaseline base_;
  CusumSample sample_;
  CusumBank bank_;
  FaultIsolation isolation_;
  RepeatWatch repeats_;
  FaultLog log_;
  double threshold_;

  std::vector<Out> out_;
  std::vector<FaultRule> rule_;  // of those out
  std::vector<char> known_;      // seen long enough to be weighed
  std::vector<char> at_end_;     // stands at the end of its range
  std::vector<double> noisy_;    // its variance over what it was; 0: not noisy
  std::vector<std::int64_t>
      judged_at_;  // last instant: out for a bias or a gain, or noisy; -1: never
  std::vector<RecoveryWindow> recovery_;
  std::vector<double> new_mean_, new_square_, new_count_;  // of newcomers
  std::vector<double> deviation_;                          // of each sensor's noise
  std::vector<double> out_step_;                           // of f, whoever is out
  std::vector<int> index_;                                 // in use now: the first m_
  std::vector<double> ring_e_, ring_x_;  // of the last kWindow instants; NaN: not here
  std::vector<WindowEvidence> evidence_;
  std::vector<double> squares_;  // mean of e^2 / s over the window
  std::vector<VarianceChange> changes_;
  std::vector<double> median_;

  int m_ = 0, count_out_ = 0, count_new_ = 0, count_noisy_ = 0, start_instants_ = 0;
  bool started_ = false, any_armed_ = false, set_changed_ = false, fresh_ = true;
  std::size_t restarts_ = 0;
  std::int64_t now_ = 0, since_change_ = 0;
  std::int64_t next_look_ = 0, last_look_ = 0, looks_ = 0;
  std::int64_t misfits_ = 0, last_misfit_ = -1;
  int misfit_sensor_ = -1;
  std::int64_t armed_again_ = 0, rest_ = 8192, stood_down_ = 0, stood_instants_ = 0;
  double fused_ = 0;
};

}  // namespace libchar::fusion

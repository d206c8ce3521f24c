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
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/fusion/array.hpp"
#include "libchar/fusion/detail/fault/cusum_bank.hpp"
#include "libchar/fusion/detail/fault/fault_baseline.hpp"
#include "libchar/fusion/detail/fault/fault_isolation.hpp"
#include "libchar/fusion/detail/fault/repeat_watch.hpp"
#include "libchar/fusion/detail/variances/reweighted_matrix.hpp"
#include "libchar/fusion/detail/variances/reweighted_variances.hpp"
#include "libchar/fusion/fault_log.hpp"

namespace libchar::fusion {

// Whether a sensor agrees with the others again: sums over its last own samples, in eight parts, of the
// innovation e (sample less what the others say), of variance s.
//
//   (sum z)^2 / n,  (sum x e)^2 / (sum x^2 s),  (sum z^2 - n) / sqrt(2 n),     z = e / sqrt(s)
//
// Each is a standard test of mean, gain and variance; all must pass. Where the fault was seen in the gain,
// the input must have moved enough to show it again.

class RecoveryWindow {
 public:
  /// `early`: the alarm itself is in doubt. A quarter of the window is looked at too, once, and a gain need
  /// not be shown again.
  void start(std::int64_t length, bool early = false) {
    *this = RecoveryWindow{};
    early_ = early;
    part_length_ = std::max<double>(static_cast<double>(length) / kParts, 1);
  }
  /// True when a part is full and the window with it.
  bool add(double e, double s, double x) {
    Sums& part = parts_[part_];
    const double z = e / std::sqrt(s);
    part.n += 1;
    part.z += z;
    part.zz += std::min(z * z, 1e12);
    part.xe += x * e / s;
    part.xx += x * x / s;
    if (part.n < part_length_) return false;
    total();
    part_ = (part_ + 1) % kParts;
    parts_[part_] = {};
    full_ = std::min(full_ + 1, kParts + 1);
    if (full_ >= 2) remember_gain();
    return full_ >= kParts || (early_ && full_ == kParts / 4);
  }
  /// Mean and slope are no more than the scatter makes them.
  bool mean_fits() const { return full_ >= kParts && fits(1, 1, std::max(sum_.zz / sum_.n, 1.0)); }
  /// z is worth `bias` of itself in a sum, x z `gain`, z^2 - 1 `noise` (long-run variances).
  bool all_fit(double bias, double gain, double noise) const { return fits(bias, gain, 1) && excess() * noise < 3.3; }
  /// The window is the first: nothing was ever wrong in it.
  bool first() const { return full_ <= kParts; }
  /// Mean square of z.
  double scatter() const { return sum_.zz / sum_.n; }

 private:
  static constexpr std::size_t kParts = 8;
  static constexpr double kLimit = 10.8;  // chi square of one, p = .001
  struct Sums {
    double n = 0, z = 0, zz = 0, xe = 0, xx = 0;
  };
  void total() {
    sum_ = {};
    for (const Sums& part : parts_) {
      sum_.n += part.n;
      sum_.z += part.z;
      sum_.zz += part.zz;
      sum_.xe += part.xe;
      sum_.xx += part.xx;
    }
  }
  /// The fault was one of gain when the slope explains more than the mean does.
  void remember_gain() {
    if (!(sum_.xx > 0)) return;
    const double explained = sum_.xe * sum_.xe / sum_.xx;
    if (explained > 25 && explained > sum_.z * sum_.z / sum_.n) gain_ = std::max(gain_, std::abs(sum_.xe / sum_.xx));
  }
  bool fits(double bias, double gain, double scatter) const {
    if (!early_ && gain_ * gain_ * sum_.xx < (gain_ > 0 ? 30 : 0)) return false;
    const double slope = sum_.xx > 0 ? sum_.xe * sum_.xe / sum_.xx : 0;
    return sum_.z * sum_.z / sum_.n * bias * bias < kLimit * scatter && slope * gain * gain < kLimit * scatter;
  }
  double excess() const { return (sum_.zz - sum_.n) / std::sqrt(2 * sum_.n); }

  std::array<Sums, kParts> parts_{};
  Sums sum_;
  std::size_t part_ = 0, full_ = 0;
  bool early_ = false;
  double part_length_ = 25, gain_ = 0;
};

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
  void remarks(const std::vector<std::string>& names, Findings& warnings) const;
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
  double variance(std::size_t i) const { return general_ ? general_->variance(i) : scalar_.variance(i); }
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
  std::vector<FaultRule> rule_;          // of those out
  std::vector<char> known_;              // seen long enough to be weighed
  std::vector<char> at_end_;             // stands at the end of its range
  std::vector<double> noisy_;            // its variance over what it was; 0: not noisy
  std::vector<std::int64_t> judged_at_;  // last instant: out for a bias or a gain, or noisy; -1: never
  std::vector<RecoveryWindow> recovery_;
  std::vector<double> new_mean_, new_square_, new_count_;  // of newcomers
  std::vector<double> deviation_;                          // of each sensor's noise
  std::vector<double> out_step_;                           // of f, whoever is out
  std::vector<int> index_;                                 // in use now: the first m_
  std::vector<double> ring_e_, ring_x_;                    // of the last kWindow instants; NaN: not here
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

// What the detector does on an alarm: the window, the consistent set, the kind of fault.

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "libchar/core/text/decimal.hpp"
#include "libchar/fusion/detail/fault/fault_detector.hpp"

namespace libchar::fusion {
namespace {

/// Instants that more than one suspect, or a contradiction, need.
constexpr int kFewInstants = 4;
/// Alarms that no set explains, or that were over at once, before the detector stands down.
constexpr int kMisfits = 3;
/// The same where it is not stated that the record begins without faults: what was learnt may be too little.
constexpr int kMisfitsUntold = 2;
/// Instants after which a contradiction is forgotten.
constexpr std::int64_t kMisfitMemory = 8192;

double noise_evidence(double samples, double square) {
  return square > 1 ? samples / 2 * (square - 1 - std::log(square)) : 0;
}

/// Residuals e of instants beside the estimate x: what they say for a bias and for a gain, over noise of variance s.
struct ResidualSums {
  double n = 0, sum = 0, x_sum = 0, xe = 0, xx = 0, squares = 0;

  /// False: a missing sample.
  bool take(double e, double x) {
    if (std::isnan(e)) return false;
    n += 1;
    sum += e;
    x_sum += x;
    xe += x * e;
    xx += x * x;
    squares += e * e;
    return true;
  }
  double bias(double s) const { return sum * sum / (2 * n * s); }
  double gain(double s) const { return xx > 0 ? xe * xe / (2 * xx * s) : 0; }
};

}  // namespace

void FaultDetector::judge() {
  std::size_t winner = 0;
  for (std::size_t i = 1; i < base_.n; ++i)
    if (bank_.top(i) > bank_.top(winner)) winner = i;
  if (now_ - last_look_ > kWindow) looks_ = 0;
  last_look_ = now_;
  ++looks_;
  next_look_ = now_ + (looks_ < 16 ? 1 : 16);

  const int window = change_point(winner);
  gather_evidence(window);
  const Isolation found = isolation_.isolate(evidence_, index_.data(), m_);
  if (found.best == 0 || found.cost_of_none - found.cost < threshold_ / 3) {
    if (bank_.leading(winner) == CusumInput::noise)
      judge_noise(window);
    else if (looks_ > 16)
      declare_faulty(winner);
  } else if (!found.consistent()) {
    if (window >= kFewInstants) misfit(-1);
  } else if (found.certain == 0) {
    // More instants may tell; evidence enough and still no answer: there is none.
    if (found.cost_of_none > 3 * threshold_ || looks_ > 24) doubt(found);
  } else if (window >= kFewInstants || std::popcount(found.best) == 1) {
    act(found, window);
  }
}

/// Instants since the change, by the largest likelihood of a bias, a gain or a noise in the winner.
int FaultDetector::change_point(std::size_t i) const {
  const int most = static_cast<int>(std::min<std::int64_t>(since_change_, kWindow));
  const double s = base_.s[i];
  ResidualSums sums;
  double best = -1;
  int where = 1;
  for (int back = 0; back < most; ++back) {
    if (!sums.take(ring_e_[at(back, i)], ring_x_[at(back, i)])) continue;
    double evidence = std::max(sums.bias(s), sums.gain(s));
    if (sums.n >= kFewInstants) evidence = std::max(evidence, noise_evidence(sums.n, sums.squares / (sums.n * s)));
    if (evidence > best) {
      best = evidence;
      where = back + 1;
    }
  }
  return where;
}

void FaultDetector::gather_evidence(int window) {
  for (int k = 0; k < m_; ++k) {
    const auto i = static_cast<std::size_t>(index_[static_cast<std::size_t>(k)]);
    ResidualSums sums;
    for (int back = 0; back < window; ++back) sums.take(ring_e_[at(back, i)], ring_x_[at(back, i)]);
    const auto& [n, sum, x_sum, xe, xx, squares] = sums;
    WindowEvidence& w = evidence_[i];
    w = {};
    squares_[i] = n > 0 ? squares / (n * base_.s[i] * base_.excess) : 1;
    if (!(n > 0)) continue;
    const double v = variance(i) * base_.start_margin[i] * base_.excess;
    const double centred = std::max(xx - x_sum * x_sum / n, 0.0);
    const double b = base_.scale_bias[i], g = base_.scale_gain[i];
    w.samples = n;
    w.mean = sum / n;
    w.mean_weight = n / v * b * b;
    w.slope = centred > 1e-9 * xx && n > 1 ? (xe - x_sum * sum / n) / centred : 0;
    w.slope_weight = centred > 1e-9 * xx && n > 1 ? centred / v * g * g : 0;
    w.suspicion = bank_.top(i);
  }
}

void FaultDetector::judge_noise(int window) {
  std::size_t noisiest = 0;
  double most = 0;
  int many = 0;
  for (int k = 0; k < m_; ++k) {
    const auto i = static_cast<std::size_t>(index_[static_cast<std::size_t>(k)]);
    const double evidence = noise_evidence(evidence_[i].samples, squares_[i]) * base_.scale_noise[i];
    many += evidence > threshold_ / 2 ? 1 : 0;
    if (evidence > most) {
      most = evidence;
      noisiest = i;
    }
  }
  if (2 * many > m_) {
    misfit(-1);
    return;
  }
  if (most < threshold_ / 3 && window < kWindow && looks_ < 16) return;
  if (squares_[noisiest] < 1.1) return;
  noise_fault(noisiest, window);
  if (most_judged_together()) stand_down();
}

/// The sum has gathered for longer than the window reaches: it is believed.
void FaultDetector::declare_faulty(std::size_t i) {
  const FaultRule rule = bank_.leading(i) == CusumInput::gain ? FaultRule::gain : FaultRule::bias;
  if (m_ <= least_healthy(rule)) {
    misfit(-1);
    return;
  }
  take_out(i, rule);
  sets_changed();
}

void FaultDetector::noise_fault(std::size_t i, int window) {
  const double spread = 1 + std::sqrt(2.0 / std::max(window, 8));
  const double ratio = 1 + (squares_[i] - 1) * variance(i) / base_.s[i];
  make_noisy(i, std::max(ratio, 1.2) * spread);
  sets_changed();
}

/// A sensor without a word about the input: its samples scatter about zero by its own noise.
bool FaultDetector::is_dead(std::size_t i, int window) const {
  double n = 0, squares = 0, input = 0;
  for (int back = 0; back < window; ++back) {
    const double e = ring_e_[at(back, i)], f = ring_x_[at(back, i)] + base_.mean_f[i];
    if (std::isnan(e)) continue;
    // The residual holds the sensor's own share in the estimate.
    const double others = f - e * (variance(i) / base_.s[i] - 1);
    const double sample = e + f;
    n += 1;
    squares += sample * sample;
    input += others * others;
  }
  const double v = variance(i) + base_.bias[i] * base_.bias[i];
  return n > 0 && squares < n * v * (1 + 4 * std::sqrt(2 / n)) && input > 25 * n * v;
}

/// Bias, gain, noise or dead; `noise` when the scatter alone explains the window best.
FaultRule FaultDetector::kind(std::size_t i, int window) const {
  if (is_dead(i, window)) return FaultRule::dead;
  ResidualSums sums;
  for (int back = 0; back < window; ++back) sums.take(ring_e_[at(back, i)], ring_x_[at(back, i)]);
  const double bias = sums.bias(base_.s[i]), gain = sums.gain(base_.s[i]);
  if (sums.n >= kFewInstants && noise_evidence(sums.n, squares_[i]) > std::max(bias, gain) + 3) return FaultRule::noise;
  return gain > bias ? FaultRule::gain : FaultRule::bias;
}

/// Sensors that must be left and one: enough to contradict each other; and where it is not stated that the record
/// begins without faults, to tell which of them is wrong then.
int FaultDetector::least_healthy(FaultRule rule) const {
  return inputs_ + (fault_free_ == 0 && rule != FaultRule::dead ? 2 : 1);
}

void FaultDetector::act(const Isolation& found, int window) {
  int healthy = m_;
  for (int k = 0; k < std::min(m_, 64); ++k) {
    if ((found.certain >> static_cast<unsigned>(k) & 1U) == 0) continue;
    const auto i = static_cast<std::size_t>(index_[static_cast<std::size_t>(k)]);
    const FaultRule rule = kind(i, window);
    if (rule == FaultRule::noise) {
      noise_fault(i, window);
    } else if (healthy > least_healthy(rule)) {
      take_out(i, rule);
      --healthy;
    } else if (window < kFewInstants && !base_.expects_outliers()) {
      base_.expect_outliers();
    } else {
      misfit(-1);
    }
  }
  sets_changed();
  int judged = 0;
  for (const Out out : out_) judged += out == Out::judged ? 1 : 0;
  // At most half of the sensors can be judged by the others; at most a quarter unless the record is stated
  // to begin without faults.
  const int n = static_cast<int>(base_.n);
  if (judged > (fault_free_ > 0 ? n / 2 : std::max(1, n / 4)) || most_judged_together()) stand_down();
}

/// More than half of the sensors within one window, for whatever reason: no faults of theirs.
bool FaultDetector::most_judged_together() const {
  int count = 0;
  for (std::size_t i = 0; i < base_.n; ++i)
    if (judged_at_[i] >= 0 && now_ - judged_at_[i] < kWindow && (out_[i] == Out::judged || noisy_[i] > 0)) ++count;
  return 2 * count > static_cast<int>(base_.n);
}

/// Two sets contradict each other, and either may be the healthy one.
void FaultDetector::doubt(const Isolation& found) {
  const auto channels = [&](std::uint64_t set) {
    std::uint64_t bits = 0;
    for (int k = 0; k < std::min(m_, 64); ++k)
      if ((set >> static_cast<unsigned>(k) & 1U) != 0 && index_[static_cast<std::size_t>(k)] < 64)
        bits |= std::uint64_t{1} << static_cast<unsigned>(index_[static_cast<std::size_t>(k)]);
    return bits;
  };
  log_.note(FaultDoubt{now_, true, channels(found.best), channels(found.other)});
  next_look_ = now_ + 2 * kWindow;
}

/// No set is consistent, or a fault was over before it could be confirmed. Once may be a
/// disturbance of a moment; again and again is another noise than the one that was learnt.
void FaultDetector::misfit(int sensor) {
  // A sensor that fails again and again for a moment is its own matter.
  bank_.reset();
  if (sensor >= 0 && !base_.expects_outliers()) return base_.expect_outliers();
  if (sensor >= 0 && sensor == misfit_sensor_) return;
  misfit_sensor_ = sensor;
  if (last_misfit_ >= 0 && now_ - last_misfit_ > kMisfitMemory) misfits_ = 0;
  last_misfit_ = now_;
  if (++misfits_ >= (fault_free_ > 0 ? kMisfits : kMisfitsUntold)) stand_down();
}

void FaultDetector::stand_down() {
  log_.note(FaultDoubt{now_, false, 0, 0});
  for (std::size_t i = 0; i < base_.n; ++i)
    if (out_[i] == Out::judged) let_in(i);
  for (std::size_t i = 0; i < base_.n; ++i) {
    base_.bias_var[i] = std::max(base_.bias_var[i], variance(i));
    base_.armed[i] = 0;
  }
  any_armed_ = false;
  misfits_ = 0;
  ++stood_down_;
  armed_again_ = now_ + rest_;
  rest_ *= 2;
  sets_changed();
}

void FaultDetector::remarks(const std::vector<std::string>& names, Findings& warnings) const {
  const auto at_time = [&](std::int64_t sample) {
    return rate_hz_ > 0 ? shortest(std::round(static_cast<double>(sample) / rate_hz_ * 100) / 100) + " s"
                        : "instant " + std::to_string(sample);
  };
  const auto list = [&](std::uint64_t set) {
    std::string text;
    for (unsigned i = 0; i < 64; ++i)
      if ((set >> i & 1U) != 0) text += (text.empty() ? "" : ", ") + channel_name(names, i);
    return text;
  };
  for (const FaultDoubt& doubt : log_.doubts()) {
    if (!doubt.ambiguous) continue;
    warnings.add("faults_ambiguous", at_time(doubt.sample) + ": channels " + list(doubt.one_side) + " contradict " +
                                         (doubt.other_side != 0 ? "channels " + list(doubt.other_side) : "the others") +
                                         ", and it is not known who is right: nobody is left out");
    break;
  }
  if (stood_down_ == 0) return;
  const double share =
      now_ > 0 ? 100 * std::min(1.0, static_cast<double>(stood_instants_) / static_cast<double>(now_)) : 0;
  warnings.add("fault_watch_stood_down", "faults of bias, gain and noise were not judged " +
                                             std::to_string(stood_down_) + (stood_down_ == 1 ? " time" : " times") +
                                             " (for " + shortest(std::round(share)) +
                                             " % of the run) because most channels were off by more than their noise "
                                             "explains: motion, misalignment or delays that differ");
}

}  // namespace libchar::fusion

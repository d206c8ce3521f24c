#include "libchar/fusion/detail/fault/fault_detector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/variances/reweighting_limits.hpp"

namespace libchar::fusion {
namespace {

/// Memory of the variances that residuals are judged by: as long as that of the means.
constexpr double kSlowGamma = 1 - 1 / FaultBaseline::kMemory;
/// False alarms of one sensor's bank with threshold h come at kBankRate e^-h a sample (fault_bench).
constexpr double kBankRate = 8;
/// Without a rate: samples between two false alarms.
constexpr double kSamplesWithoutRate = 2e7;
/// A square below so many rounding errors proves nothing.
constexpr double kRoundingErrors = 1e4;
/// Own samples by which a newcomer is known.
constexpr double kNewcomerSamples = 256;
/// Own samples after which the falling gain of the variances starts anew: until then the means were learnt.
constexpr double kMeansLearnt[] = {256, 2048};

double threshold_of(const Array& array, const FaultDetectorOptions& options) {
  const double samples = array.rate_hz > 0 ? options.false_alarm_s * array.rate_hz : kSamplesWithoutRate;
  return std::log(std::max(kBankRate * static_cast<double>(array.channels) * samples, 100.0));
}

FaultDetectorOptions with_recovery(FaultDetectorOptions options, double rate_hz) {
  constexpr std::int64_t kUsual = 200, kLeast = 64, kFewest = 16;
  constexpr double kLongest_s = 2;
  if (options.recovery > 0) {
    options.recovery = std::max(options.recovery, kFewest);
    return options;
  }
  options.recovery = kUsual;
  if (rate_hz > 0) options.recovery = clamped_whole<std::int64_t>(std::round(kLongest_s * rate_hz), kLeast, kUsual);
  return options;
}

}  // namespace

FaultDetector::FaultDetector(const Array& array, const FaultDetectorOptions& options)
    : options_(with_recovery(options, array.rate_hz)),
      inputs_(static_cast<int>(array.inputs())),
      rate_hz_(array.rate_hz),
      fault_free_(array.fault_free_samples),
      scalar_(static_cast<std::size_t>(array.channels), {.gamma = kSlowGamma}),
      base_(static_cast<std::size_t>(array.channels)),
      sample_(base_.padded),
      bank_(base_.n),
      isolation_(array.h(), base_.n),
      repeats_(base_.n, threshold_of(array, options)),
      threshold_(threshold_of(array, options)),
      out_(base_.n, Out::no),
      rule_(base_.n, FaultRule::bias),
      known_(base_.n, 0),
      at_end_(base_.n, 0),
      noisy_(base_.n, 0),
      judged_at_(base_.n, -1),
      recovery_(base_.n),
      new_mean_(base_.n, 0),
      new_square_(base_.n, 0),
      new_count_(base_.n, 0),
      deviation_(base_.n, 1),
      out_step_(base_.n, 0),
      index_(base_.n, 0),
      ring_e_(base_.padded * kWindow, 0),
      ring_x_(base_.padded * kWindow, 0),
      evidence_(base_.n),
      squares_(base_.n, 1) {
  changes_.reserve(2 * base_.n);
  base_.forget_blocks(fault_free_ > 0);
  median_.reserve(base_.n);
  if (!array.one_common_input()) general_.emplace(array.h(), ReweightingOptions{.gamma = kSlowGamma});
}

void FaultDetector::step(const double* y) {
  changes_.clear();
  set_changed_ = false;
  if (!started_)
    start(y);
  else if (general_)
    step_with(*general_, y);
  else
    step_with(scalar_, y);
  ++now_;
}

// ---- The start: medians, so that one sensor that is far off does not move the others.

void FaultDetector::start(const double* y) {
  int present = 0;
  double* const row = &ring_e_[static_cast<std::size_t>(start_instants_) * base_.padded];
  for (std::size_t i = 0; i < base_.n; ++i) {
    row[i] = usable(y[i]) ? y[i] : std::numeric_limits<double>::quiet_NaN();
    present += usable(y[i]) ? 1 : 0;
  }
  if (present >= inputs_ + 2 && ++start_instants_ == kStart) begin();
}

void FaultDetector::begin() {
  std::vector<double>& mean = new_mean_;
  for (int k = 0; k < kStart; ++k) {
    double* const row = &ring_e_[static_cast<std::size_t>(k) * base_.padded];
    median_.clear();
    for (std::size_t i = 0; i < base_.n; ++i)
      if (!std::isnan(row[i])) median_.push_back(row[i]);
    const double middle = median_in_place(median_, Middle::upper);
    for (std::size_t i = 0; i < base_.n; ++i) {
      if (std::isnan(row[i])) continue;
      const double off = general_ ? 0 : row[i] - middle;
      new_count_[i] += 1;
      const double by = off - mean[i];
      mean[i] += by / new_count_[i];
      new_square_[i] += by * (off - mean[i]);
    }
  }
  for (std::size_t i = 0; i < base_.n; ++i) {
    known_[i] = new_count_[i] >= kHalfStart ? 1 : 0;
    if (known_[i] == 0) ++count_new_;
    if (known_[i] != 0) base_.bias[i] = mean[i];
    squares_[i] = known_[i] != 0 ? std::max(new_square_[i] / (new_count_[i] - 1), kTiny) : 0;
  }
  const double largest = std::max(*std::max_element(squares_.begin(), squares_.end()), kTiny);
  for (std::size_t i = 0; i < base_.n; ++i)
    squares_[i] = std::max(squares_[i] > 0 ? squares_[i] : largest, largest * kSmallestRatio);
  if (!general_) scalar_.begin(squares_.data(), kHalfStart);
  for (std::size_t i = 0; i < base_.n; ++i) base_.bias_var[i] = squares_[i];
  for (std::vector<double>* v : {&new_mean_, &new_square_, &new_count_}) std::fill(v->begin(), v->end(), 0.0);
  std::fill(ring_e_.begin(), ring_e_.end(), std::numeric_limits<double>::quiet_NaN());
  started_ = true;
}

// ---- An instant.

template <class Variances>
void FaultDetector::step_with(Variances& variances, const double* y) {
  const bool enough = use(y);
  if (m_ <= inputs_ || !residuals(variances, y)) {
    base_.had_f.fill(0);
    return;
  }
  if (!enough) {
    // No sensor can be judged, but those that are out may come in again.
    if (count_out_ > 0) follow_out(variances, y);
    watch_repeats(y);
    return;
  }
  base_.find_motion();
  base_.standardise(sample_);
  if (now_ % 8 == 0) base_.find_excess(index_.data(), m_, median_);
  note_window();
  ++since_change_;
  const double top = any_armed_ ? bank_.step(sample_) : 0;
  const std::int64_t before = since_change_;
  if (top > threshold_ && now_ >= next_look_) judge();
  // What a failing sensor has done to the residuals of this instant is not to be learnt.
  if (since_change_ == before) {
    const double frozen = threshold_ / 2;
    base_.learn(bank_.all_tops(), frozen);
    if (now_ % 4 == 0) base_.learn_motion(bank_.all_tops(), frozen);
    if (top <= frozen) variances.update();
    if (count_noisy_ > 0) follow_noisy();
  }
  if (count_out_ > 0) follow_out(variances, y);
  if (count_new_ > 0) meet_newcomers(variances, y);
  watch_repeats(y);
  if (now_ % 64 == 0 || now_ + 1 == fault_free_) slow_work(variances);
}

/// Who takes part: here, known and not out. False: too few to judge anybody.
bool FaultDetector::use(const double* y) {
  m_ = 0;
  for (std::size_t i = 0; i < base_.n; ++i) {
    const bool in = usable(y[i]) && known_[i] != 0 && out_[i] == Out::no;
    base_.here[i] = in ? 1 : 0;
    if (in) index_[static_cast<std::size_t>(m_++)] = static_cast<int>(i);
  }
  return m_ >= inputs_ + 2;
}

template <class Variances>
bool FaultDetector::residuals(Variances& variances, const double* y) {
  const double x = variances.fuse(y, index_.data(), m_);
  if (!(std::abs(x) <= kLargestSample)) return false;
  if (!general_)
    base_.f.fill(x);
  else
    for (std::size_t i = 0; i < base_.n; ++i)
      base_.f[i] = base_.here[i] != 0 ? y[i] - variances.residuals()[i] : -variances.innovation(i, 0);
  if (fresh_) {
    base_.mean_f.take(base_.f);
    base_.last_f.take(base_.f);
  }
  fresh_ = false;
  if (count_out_ > 0)
    for (std::size_t i = 0; i < base_.n; ++i) out_step_[i] = base_.f[i] - base_.last_f[i];
  std::copy(y, y + base_.n, base_.y.begin());
  base_.predict();
  fused_ = variances.fuse(base_.y.data(), index_.data(), m_);
  if (!variances.started()) {
    variances.update();
    return false;
  }
  const double least = kRoundingErrors * variances.rounding();
  const double* const e = variances.residuals();
  const double* const s = variances.residual_variances();
  for (std::size_t i = 0; i < base_.n; ++i) {
    const bool here = base_.here[i] != 0;
    base_.e[i] = here ? e[i] : 0;
    base_.s[i] = here ? std::max(s[i], least) : 1;
  }
  return true;
}

void FaultDetector::note_window() {
  const std::size_t row = at(0, 0);
  for (std::size_t i = 0; i < base_.n; ++i) {
    // Of noise that follows the motion each instant counts by its own variance.
    const double by = base_.motion(i) != 1 ? 1 / std::sqrt(base_.motion(i)) : 1;
    ring_e_[row + i] = base_.here[i] != 0 ? base_.e[i] * by : std::numeric_limits<double>::quiet_NaN();
    ring_x_[row + i] = base_.x[i] * by;
  }
}

/// Floors, units, arming: what hardly changes in 64 instants.
template <class Variances>
void FaultDetector::slow_work(Variances& variances) {
  base_.renew(FaultBaseline::kMemory, median_);
  if (now_ % FaultBaseline::kBlock == 0) base_.renew_motion(FaultBaseline::kBlock / 4);
  const bool wait = now_ + 1 < fault_free_ || now_ < armed_again_;
  any_armed_ = false;
  double samples = 0;
  for (std::size_t i = 0; i < base_.n; ++i) {
    const bool armed = !wait && known_[i] != 0 && base_.count[i] >= static_cast<double>(options_.learning);
    base_.armed[i] = armed ? 1 : 0;
    any_armed_ = any_armed_ || armed;
    deviation_[i] = std::sqrt(variances.variance(i));
    samples = std::max(samples, base_.count[i]);
  }
  if (restarts_ < std::size(kMeansLearnt) && samples >= kMeansLearnt[restarts_]) {
    variances.restart(kHalfStart);
    base_.forget_blocks(fault_free_ > 0);
    ++restarts_;
  }
  if (now_ < armed_again_) stood_instants_ += 64;
  if (now_ % FaultBaseline::kBlock == 0) base_.end_block(fault_free_ > 0, bank_.all_tops(), threshold_ / 2);
}

// ---- Values that repeat.

void FaultDetector::watch_repeats(const double* y) {
  for (std::size_t i = 0; i < base_.n; ++i) {
    if (!usable(y[i]) || known_[i] == 0) continue;
    if (repeats_.take_in(i, y[i], base_.f[i], deviation_[i])) repeat_state(i);
  }
}

void FaultDetector::repeat_state(std::size_t i) {
  const RepeatWatch::State state = repeats_.state(i);
  if (state == RepeatWatch::State::saturated && at_end_[i] == 0) {
    at_end_[i] = 1;
    log_.note(FaultEvent{now_, static_cast<int>(i), true, FaultRule::saturated});
  }
  if (at_end_[i] != 0 && state == RepeatWatch::State::saturated) {
    // Where the others stand at the same end, no other knows better.
    if (out_[i] == Out::no && m_ > inputs_ + 1 && repeats_.others_beyond(i, base_.f[i], 2 * deviation_[i])) {
      out_[i] = Out::saturated;
      ++count_out_;
      sets_changed();
    }
    return;
  }
  if (at_end_[i] != 0) {
    at_end_[i] = 0;
    log_.note(FaultEvent{now_, static_cast<int>(i), false, FaultRule::saturated});
    if (out_[i] == Out::saturated) {
      out_[i] = Out::no;
      --count_out_;
      sets_changed();
    }
  }
  if (state == RepeatWatch::State::stuck && base_.armed[i] != 0) {
    if (out_[i] == Out::no && m_ > inputs_ + 1) {
      take_out(i, FaultRule::stuck);
      sets_changed();
    }
    if (out_[i] == Out::judged) out_[i] = Out::stuck;
  } else if (out_[i] == Out::stuck && state == RepeatWatch::State::moving) {
    out_[i] = Out::judged;
    recovery_[i].start(options_.recovery);
  }
}

// ---- Those that are out, new, or noisier than they were.

template <class Variances>
void FaultDetector::follow_out(Variances& variances, const double* y) {
  for (std::size_t i = 0; i < base_.n; ++i) {
    if (out_[i] != Out::judged || !usable(y[i])) continue;
    const double x = base_.f[i] - base_.mean_f[i];
    const double sample = y[i] - (base_.bias[i] + base_.gain[i] * x + base_.delay[i] * out_step_[i]);
    const double e = variances.innovation(i, sample);
    const double s = std::max(
        variances.innovation_variance(i) * base_.start_margin[i] * base_.motion_at(i, x) + base_.gain_var[i] * x * x,
        kRoundingErrors * variances.rounding());
    if (!recovery_[i].add(e, s, x)) continue;
    const RecoveryWindow& window = recovery_[i];
    if (window.all_fit(base_.scale_bias[i], base_.scale_gain[i], base_.scale_noise[i])) {
      const bool at_once = window.first();
      let_in(i);
      if (at_once) misfit(static_cast<int>(i));
    } else if (window.scatter() > 1.5 && window.mean_fits()) {
      // What it says is right, but scattered: that is a matter of weight.
      const double ratio = 1 + (window.scatter() - 1) * s / variances.variance(i);
      let_in(i);
      make_noisy(i, ratio);
    }
  }
}

template <class Variances>
void FaultDetector::meet_newcomers(Variances& variances, const double* y) {
  for (std::size_t i = 0; i < base_.n; ++i) {
    if (known_[i] != 0 || !usable(y[i])) continue;
    const double e = variances.innovation(i, y[i]);
    new_count_[i] += 1;
    const double by = e - new_mean_[i];
    new_mean_[i] += by / new_count_[i];
    new_square_[i] += by * (e - new_mean_[i]);
    if (new_count_[i] < kNewcomerSamples) continue;
    const double square = new_square_[i] / (new_count_[i] - 1);
    const double shared = variances.innovation_variance(i) - variances.variance(i);
    variances.assume(i, std::max({square - shared, 0.01 * square, kTiny}));
    base_.bias[i] = new_mean_[i];
    base_.bias_var[i] = square / new_count_[i];
    // Its variance is known from few samples, and the weights of all hang on it: none is judged before
    // all have been seen with it.
    variances.restart(kNewcomerSamples);
    for (std::size_t k = 0; k < base_.n; ++k) base_.count[k] = std::min(base_.count[k], kNewcomerSamples);
    base_.count[i] = kNewcomerSamples;
    base_.mean_f[i] = base_.f[i];
    known_[i] = 1;
    --count_new_;
    sets_changed();
  }
}

void FaultDetector::follow_noisy() {
  for (std::size_t i = 0; i < base_.n; ++i) {
    if (!(noisy_[i] > 0) || base_.here[i] == 0) continue;
    if (!recovery_[i].add(base_.z[i], 1, 0)) continue;
    if (recovery_[i].scatter() > 1 / std::sqrt(noisy_[i])) continue;
    if (recovery_[i].first()) base_.expect_outliers();
    change_variance(i, 1 / noisy_[i]);
    noisy_[i] = 0;
    --count_noisy_;
    log_.note(FaultEvent{now_ + 1, static_cast<int>(i), false, FaultRule::noise});
    sets_changed();
  }
}

void FaultDetector::make_noisy(std::size_t i, double ratio) {
  if (!(noisy_[i] > 0)) ++count_noisy_;
  noisy_[i] = std::max(noisy_[i], 1.0) * ratio;
  recovery_[i].start(options_.recovery);
  change_variance(i, ratio);
  judged_at_[i] = now_;
  log_.note(FaultEvent{now_, static_cast<int>(i), true, FaultRule::noise});
}

void FaultDetector::change_variance(std::size_t i, double ratio) {
  if (general_)
    general_->assume(i, general_->variance(i) * ratio);
  else
    scalar_.assume(i, scalar_.variance(i) * ratio);
  changes_.push_back({static_cast<int>(i), ratio});
}

void FaultDetector::take_out(std::size_t i, FaultRule rule) {
  if (noisy_[i] > 0) {
    noisy_[i] = 0;
    --count_noisy_;
    log_.note(FaultEvent{now_, static_cast<int>(i), false, FaultRule::noise});
  }
  out_[i] = rule == FaultRule::stuck ? Out::stuck : Out::judged;
  rule_[i] = rule;
  if (rule == FaultRule::bias || rule == FaultRule::gain) judged_at_[i] = now_;
  recovery_[i].start(options_.recovery, fault_free_ == 0);
  ++count_out_;
  log_.note(FaultEvent{now_, static_cast<int>(i), true, rule});
}

void FaultDetector::let_in(std::size_t i) {
  out_[i] = Out::no;
  --count_out_;
  log_.note(FaultEvent{now_ + 1, static_cast<int>(i), false, rule_[i]});
  sets_changed();
}

/// Residuals are those of another set from here on: evidence starts anew.
void FaultDetector::sets_changed() {
  set_changed_ = true;
  bank_.reset();
  since_change_ = 0;
  next_look_ = looks_ = 0;
}

}  // namespace libchar::fusion

#include "libchar/fusion/detail/simplex/taught_network.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {
namespace {

constexpr std::size_t kTerms = 4;             // of a cubic
constexpr double kParityMemory = 128;         // instants
constexpr double kAwayMemory = 1024;          // instants
constexpr double kMargin = 0.15;              // of the range of an input, on either side
constexpr double kLevelMargin = 0.05;         // of that of the level
constexpr double kSigmas = 4;                 // of the baseline
constexpr double kApart = 1.2, kDrift = 1.5;  // of the largest that was seen
constexpr double kChance = 4;                 // standard errors of a mean of white residuals
constexpr double kCalmAgain = 0.7;            // of its limit
constexpr int kCalm = 32;                     // good instants before the network leads again
constexpr double kLeastGain = 0.06;           // of the mean square error
constexpr double kErrors = 2.5;               // standard errors of that gain
constexpr double kAgeing = 9;                 // of the square that the network has aged by since it learnt
constexpr std::size_t kJudgedPerSlice = 16;

}  // namespace

TaughtNetwork::TaughtNetwork(std::size_t sensors, std::size_t lags, const TanhNetwork& shape)
    : net(shape), past_((lags + 1) * sensors), s_(sensors), mean_(sensors), calm_(kCalm) {
  set.used.assign(sensors, 1);
  set.lags = lags;
  for (auto* part : {&limits.low, &limits.high, &z_, &scratch_}) part->resize(set.inputs());
  limits.reading.resize(kTerms * sensors);
  limits.deviation.resize(sensors);
  limits.drift.resize(sensors);
}

void TaughtNetwork::start_over() {
  std::fill(mean_.begin(), mean_.end(), 0);
  calm_ = kCalm;
  away_ = limits.away;
  drifts_ = worse_ = false;
}

double TaughtNetwork::estimate(const double* past, double* z) const {
  const double c = set.fill(past, z);
  return c + net.output(z, scratch_.data());
}

void TaughtNetwork::parity(double x, const double* y, double* s) const {
  const double u = (x - limits.centre) / limits.unit;
  for (std::size_t i = 0; i < set.used.size(); ++i) {
    const double* const r = limits.reading.data() + kTerms * i;
    s[i] = set.used[i] != 0 && limits.deviation[i] > 0
               ? (y[i] - (r[0] + u * (r[1] + u * (r[2] + u * r[3])))) / limits.deviation[i]
               : 0;
  }
}

bool TaughtNetwork::within(const double* z) const {
  for (std::size_t i = 0; i < set.inputs(); ++i)
    if (!(z[i] >= limits.low[i] && z[i] <= limits.high[i])) return false;
  return true;
}

bool TaughtNetwork::consistent(const double* y) {
  parity(x_, y, s_.data());
  double furthest = 0;
  for (std::size_t i = 0; i < s_.size(); ++i) {
    if (set.used[i] == 0) continue;
    // A single wild sample is the business of the other rules.
    const double s = std::clamp(s_[i], -kParityMemory, kParityMemory);
    mean_[i] += (s - mean_[i]) / kParityMemory;
    furthest = std::max(furthest, std::abs(mean_[i]) / limits.drift[i]);
  }
  drifts_ = furthest > (drifts_ ? kCalmAgain : 1);
  return !drifts_;
}

bool TaughtNetwork::still_better(double baseline) {
  away_ += ((x_ - baseline) * (x_ - baseline) - away_) / kAwayMemory;
  worse_ = away_ - limits.away > (worse_ ? kCalmAgain : 1) * limits.gain;
  return !worse_;
}

int TaughtNetwork::worst(const std::vector<char>& apart_from) const {
  int out = -1;
  double furthest = 0;
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    if (set.used[i] == 0 || apart_from[i] != 0) continue;
    const double far = std::abs(mean_[i]) / limits.drift[i];
    if (far <= furthest) continue;
    furthest = far;
    out = static_cast<int>(i);
  }
  return out;
}

bool TaughtNetwork::good(HandOverReason reason, bool passed) {
  if (!passed) {
    calm_ = 0;
    reason_ = reason;
    return false;
  }
  return true;
}

bool TaughtNetwork::judge(const RecentPast& past, const double* y, const BaselineView& baseline) {
  bool there = past.full() && set.complete(y);
  for (std::size_t i = 0; there && i < set.used.size(); ++i)
    there = set.used[i] == 0 || baseline.left_out == nullptr || baseline.left_out[i] == 0;
  if (!there) return good(HandOverReason::missing, false);
  past.copy_to(past_.data());
  x_ = estimate(past_.data(), z_.data());
  if (!good(HandOverReason::outside, within(z_.data()))) return false;
  const double variance = baseline.variance > 0 ? baseline.variance : 0;
  if (!good(HandOverReason::apart, std::abs(x_ - baseline.x) <= limits.apart + kSigmas * std::sqrt(variance)))
    return false;
  const bool better = still_better(baseline.x);
  if (!good(HandOverReason::inconsistent, consistent(y)) || !good(HandOverReason::apart, better)) return false;
  if (calm_ < kCalm) ++calm_;
  if (calm_ == kCalm) reason_ = HandOverReason::right;
  return calm_ == kCalm;
}

void TaughtNetwork::exchange(LearntExchange& with) {
  double passed = right ? 1 : 0;
  with.number("right", passed);
  right = passed != 0;
  with.numbers("means", net.mean);
  with.numbers("scales", net.scale);
  with.numbers("affine", net.affine);
  with.numbers("parameters", net.parameters);
  with.number("residual_scale", net.residual_scale);
  with.number("variance", net.held_out_square);
  with.numbers("low", limits.low);
  with.numbers("high", limits.high);
  with.number("apart", limits.apart);
  with.number("away", limits.away);
  with.number("gain", limits.gain);
  with.number("centre", limits.centre);
  with.number("unit", limits.unit);
  with.numbers("reading", limits.reading);
  with.numbers("deviations", limits.deviation);
  with.numbers("drifts", limits.drift);
}

Teaching::Teaching(const TaughtRows& rows, std::size_t lags, const TanhNetwork& shape, std::uint64_t seed)
    : rows_(rows),
      fit_(shape, std::max<std::size_t>(rows.training() + rows.held_out(), 1)),
      made_(rows.sensors(), lags, shape),
      past_(rows.sensors(), lags),
      seed_(seed),
      inverse_(rows.sensors()),
      z_(shape.inputs) {
  const std::size_t n = rows.sensors();
  source_.rows = &rows_;
  source_.set = &made_.set;
  readings_.power.resize(kTerms * kTerms);
  readings_.side.resize(kTerms * n);
  readings_.squares.resize(n);
  readings_.means.resize(n);
  held_.gain.resize(kBlocks);
  held_.gain_weighted.resize(kBlocks);
  tail_.mean.resize(n);
  tail_.largest.resize(n);
}

void Teaching::begin(const std::vector<char>& used, const double* variances) {
  std::copy(used.begin(), used.end(), made_.set.used.begin());
  made_.right = false;
  made_.start_over();
  for (std::size_t i = 0; i < inverse_.size(); ++i)
    inverse_[i] = used[i] != 0 && variances[i] > 0 ? 1 / variances[i] : 0;
  phase_ = Phase::idle;
  fit_.begin(source_, rows_.training(), rows_.held_out(), seed_);
}

bool Teaching::advance() {
  if (fit_.busy()) {
    if (fit_.advance()) start_judgement();
    return !busy();
  }
  if (phase_ == Phase::idle) return false;
  const std::size_t end = std::min(phase_rows(), at_ + kJudgedPerSlice);
  for (; at_ < end; ++at_) switch (phase_) {
      case Phase::range:
        add_range(at_);
        break;
      case Phase::reading:
        add_reading(at_);
        break;
      case Phase::held_out:
        add_held_out(at_);
        break;
      default:
        add_tail(at_);
    }
  if (at_ >= phase_rows()) end_of_phase();
  return !busy();
}

void Teaching::finish_at_once(std::size_t starts) {
  fit_.finish_at_once(starts);
  start_judgement();
  while (busy()) advance();
}

// Without the heap: the room of both is the same.
void Teaching::start_judgement() {
  const FittedNetwork& from = fit_.fitted();
  if (!from.fitted()) return;
  FittedNetwork& to = made_.net;
  std::copy(from.mean.begin(), from.mean.end(), to.mean.begin());
  std::copy(from.scale.begin(), from.scale.end(), to.scale.begin());
  std::copy(from.affine.begin(), from.affine.end(), to.affine.begin());
  std::copy(from.parameters.begin(), from.parameters.end(), to.parameters.begin());
  to.residual_scale = from.residual_scale;
  to.held_out_square = from.held_out_square;
  NetworkLimits& limits = made_.limits;
  std::fill(limits.low.begin(), limits.low.end(), std::numeric_limits<double>::infinity());
  std::fill(limits.high.begin(), limits.high.end(), -std::numeric_limits<double>::infinity());
  limits.centre = rows_.truth(0);
  double low = limits.centre, high = limits.centre;
  for (std::size_t k = 0; k < rows_.training(); ++k) {
    low = std::min(low, rows_.truth(k));
    high = std::max(high, rows_.truth(k));
  }
  limits.centre = low + (high - low) / 2;
  limits.unit = high > low ? (high - low) / 2 : 1;
  next(Phase::range);
}

std::size_t Teaching::phase_rows() const {
  switch (phase_) {
    case Phase::range:
      return rows_.training() + rows_.held_out();
    case Phase::reading:
      return rows_.training();
    case Phase::held_out:
      return rows_.held_out();
    case Phase::tail:
      return rows_.tail();
    default:
      return 0;
  }
}

void Teaching::next(Phase phase) {
  phase_ = phase;
  at_ = 0;
  if (phase == Phase::reading) {
    for (auto* part : {&readings_.power, &readings_.side, &readings_.squares, &readings_.means})
      std::fill(part->begin(), part->end(), 0);
  }
  if (phase == Phase::held_out) {
    held_.network = held_.baseline = held_.weighted = held_.away = 0;
    std::fill(held_.gain.begin(), held_.gain.end(), 0);
    std::fill(held_.gain_weighted.begin(), held_.gain_weighted.end(), 0);
  }
  if (phase == Phase::tail) {
    tail_.network = tail_.baseline = tail_.apart = 0;
    tail_.away = made_.limits.away = held_.away;
    tail_.count = 0;
    std::fill(tail_.mean.begin(), tail_.mean.end(), 0);
    std::fill(tail_.largest.begin(), tail_.largest.end(), 0);
    past_.forget();
  }
}

void Teaching::add_range(std::size_t k) {
  made_.set.fill(rows_.past(k), z_.data());
  for (std::size_t i = 0; i < z_.size(); ++i) {
    made_.limits.low[i] = std::min(made_.limits.low[i], z_[i]);
    made_.limits.high[i] = std::max(made_.limits.high[i], z_[i]);
  }
}

void Teaching::add_reading(std::size_t k) {
  const double u = (rows_.truth(k) - made_.limits.centre) / made_.limits.unit;
  const double powers[kTerms] = {1, u, u * u, u * u * u};
  for (std::size_t p = 0; p < kTerms; ++p) {
    for (std::size_t q = 0; q < kTerms; ++q) readings_.power[p * kTerms + q] += powers[p] * powers[q];
    for (std::size_t i = 0; i < inverse_.size(); ++i) readings_.side[i * kTerms + p] += powers[p] * rows_.past(k)[i];
  }
}

void Teaching::solve_readings() {
  double matrix[kTerms * kTerms];
  for (std::size_t i = 0; i < inverse_.size(); ++i) {
    std::copy(readings_.power.begin(), readings_.power.end(), matrix);
    double* const side = readings_.side.data() + i * kTerms;
    if (!solve_in_place(matrix, side, kTerms, 1e-9)) std::fill(side, side + kTerms, 0);
    std::copy(side, side + kTerms, made_.limits.reading.begin() + static_cast<std::ptrdiff_t>(i * kTerms));
    made_.limits.deviation[i] = 1;
  }
}

double Teaching::weighted(const double* y) const {
  double sum = 0, weights = 0, first = 0;
  for (std::size_t i = 0; i < inverse_.size(); ++i) {
    if (inverse_[i] == 0) continue;
    if (weights == 0) first = y[i];
    sum += inverse_[i] * (y[i] - first);
    weights += inverse_[i];
  }
  return weights > 0 ? first + sum / weights : made_.set.centre(y);
}

bool Teaching::whole() const {
  return std::all_of(made_.set.used.begin(), made_.set.used.end(), [](char u) { return u != 0; });
}

// Errors of the network, of the baseline as it was, and of the baseline with the weights that it has now.
void Teaching::add_held_out(std::size_t k) {
  const std::size_t at = rows_.training() + k;
  const double truth = rows_.truth(at), x = made_.estimate(rows_.past(at), z_.data());
  const double network = (x - truth) * (x - truth);
  const double weighted_error = weighted(rows_.past(at)) - truth;
  double baseline = rows_.estimate(at) - truth;
  if (!whole() || !std::isfinite(baseline)) baseline = weighted_error;
  held_.network += network;
  held_.baseline += baseline * baseline;
  held_.away += (x - truth - baseline) * (x - truth - baseline) / static_cast<double>(rows_.held_out());
  held_.weighted += weighted_error * weighted_error;
  const std::size_t block = k * kBlocks / rows_.held_out();
  held_.gain[block] += baseline * baseline - network;
  held_.gain_weighted[block] += weighted_error * weighted_error - network;
  made_.parity(x, rows_.past(at), made_.s_.data());
  for (std::size_t i = 0; i < made_.s_.size(); ++i) {
    readings_.squares[i] += made_.s_[i] * made_.s_[i];
    readings_.means[i] += made_.s_[i] / static_cast<double>(rows_.held_out());
  }
}

// The last instants as they followed each other: how far apart both were, and how long residuals lasted.
void Teaching::add_tail(std::size_t k) {
  const double* const row = rows_.tail_row(k);
  const std::size_t n = rows_.sensors();
  past_.push(row);
  if (!past_.full() || !made_.set.complete(row)) return;
  past_.copy_to(made_.past_.data());
  const double x = made_.estimate(made_.past_.data(), z_.data()), truth = row[n];
  double baseline = row[n + 1];
  if (!whole() || !std::isfinite(baseline)) baseline = weighted(row);
  ++tail_.count;
  tail_.network += (x - truth) * (x - truth);
  tail_.baseline += (baseline - truth) * (baseline - truth);
  tail_.apart = std::max(tail_.apart, std::abs(x - baseline));
  tail_.away += ((x - baseline) * (x - baseline) - tail_.away) / kAwayMemory;
  made_.limits.away = std::max(made_.limits.away, tail_.away);
  made_.parity(x, row, made_.s_.data());
  for (std::size_t i = 0; i < n; ++i) {
    tail_.mean[i] += (made_.s_[i] - tail_.mean[i]) / kParityMemory;
    tail_.largest[i] = std::max(tail_.largest[i], std::abs(tail_.mean[i]));
  }
}

void Teaching::end_of_phase() {
  switch (phase_) {
    case Phase::range: {
      NetworkLimits& limits = made_.limits;
      for (std::size_t i = 0; i < limits.low.size(); ++i) {
        const double margin = (i == 0 ? kLevelMargin : kMargin) * (limits.high[i] - limits.low[i]);
        limits.low[i] -= margin;
        limits.high[i] += margin;
      }
      return next(Phase::reading);
    }
    case Phase::reading:
      solve_readings();
      return next(Phase::held_out);
    case Phase::held_out:
      for (std::size_t i = 0; i < readings_.squares.size(); ++i)
        made_.limits.deviation[i] = std::sqrt(readings_.squares[i] / static_cast<double>(rows_.held_out()));
      return next(Phase::tail);
    case Phase::tail:
      return conclude();
    default:
      return;
  }
}

// At the middle of what was learnt: an offset of sensor i, now and in the past alike.
double Teaching::ageing() {
  const FittedNetwork& net = made_.net;
  double in_use = 0, out = 0;
  for (const char used : made_.set.used) in_use += used != 0 ? 1 : 0;
  std::copy(net.mean.begin(), net.mean.end(), z_.begin());
  const double middle = net.output(z_.data(), made_.scratch_.data());
  for (std::size_t i = 0; i < made_.set.used.size(); ++i) {
    if (made_.set.used[i] == 0) continue;
    const double offset = readings_.means[i];
    std::copy(net.mean.begin(), net.mean.end(), z_.begin());
    z_[0] += offset / in_use;
    for (std::size_t j = 0; j < made_.set.used.size(); ++j)
      if (made_.set.used[j] != 0) z_[j + 1] += (i == j ? offset : 0) - offset / in_use;
    const double moved = offset / in_use + net.output(z_.data(), made_.scratch_.data()) - middle;
    out += moved * moved;
  }
  return out;
}

void Teaching::conclude() {
  phase_ = Phase::idle;
  const auto count = static_cast<double>(rows_.held_out());
  const bool as_it_was = held_.baseline <= held_.weighted;
  const std::vector<double>& gain = as_it_was ? held_.gain : held_.gain_weighted;
  held_.network /= count;
  held_.baseline = std::min(held_.baseline, held_.weighted) / count;
  double mean = 0, square = 0;
  for (const double g : gain) mean += g / kBlocks;
  for (const double g : gain) square += (g - mean) * (g - mean) / (kBlocks - 1);
  made_.limits.apart = kApart * tail_.apart;
  made_.away_ = made_.limits.away;
  made_.limits.gain = held_.baseline - held_.network;
  for (std::size_t i = 0; i < tail_.largest.size(); ++i)
    made_.limits.drift[i] = kDrift * tail_.largest[i] + kChance / std::sqrt(2 * kParityMemory);
  made_.net.held_out_square = held_.network;
  made_.right = std::isfinite(held_.network) &&
                held_.network + kAgeing * ageing() < (1 - kLeastGain) * held_.baseline &&
                mean > kErrors * std::sqrt(square / kBlocks) && tail_.count > 0 && tail_.network <= tail_.baseline;
}

}  // namespace libchar::fusion

#include "libchar/fusion/detail/simplex/past_network.hpp"

#include <algorithm>
#include <cmath>

namespace libchar::fusion {
namespace {

constexpr std::size_t kPastHeldOut = PastNetwork::kRing / 4;
constexpr double kSlow = 2048, kQuick = 32;         // instants of memory
constexpr double kSettled = 1024;                   // instants before it may lead
constexpr double kPastErrors = 3;                   // standard errors
constexpr double kPays = 0.04, kPaysNoMore = 0.02;  // of the mean square error
constexpr double kLeastLeft = 0.05;                 // of the variance
constexpr double kPastSigmas = 4;                   // of an innovation
constexpr int kPastCalm = 16;

}  // namespace

void PastNetwork::Mean::add(double value, double memory) {
  count = std::min(count + 1, memory);
  mean += (value - mean) / count;
  square += (value * value - square) / count;
}

double PastNetwork::Mean::error(double memory) const {
  const double n = std::max(1.0, std::min(count, memory));
  return std::sqrt(std::max(0.0, square - mean * mean) / n);
}

PastNetwork::PastNetwork(std::uint64_t seed)
    : recent_(kRing), fit_({kInputs, kHidden}, kRing), active_({kInputs, kHidden}), seed_(seed) {
  rows_.values.resize(kRing);
}

void PastNetwork::inputs_of(const Series& series, double* z) {
  for (std::size_t j = 0; j < kInputs; ++j) z[j] = series.at(0) - series.at(std::size_t{1} << j);
}

double PastNetwork::Rows::row(std::size_t k, double* input) const {
  const double* const now = values.data() + kRoom + k;
  for (std::size_t j = 0; j < kInputs; ++j) input[j] = now[-1] - *(now - 1 - (std::size_t{1} << j));
  return now[0] - now[-1];
}

double PastNetwork::predicted(const Series& series) {
  double z[kInputs], scratch[kInputs];
  inputs_of(series, z);
  return series.at(0) + active_.output(z, scratch);
}

void PastNetwork::keep(double x) {
  fused_.push(x);
  recent_[kept_ % kRing] = x;
  ++kept_;
}

// A fit each time that as much again has been seen: it gets rarer, and memory and time stay bounded.
void PastNetwork::adapt() {
  if (fit_.busy()) {
    if (!fit_.advance() || !fit_.fitted().fitted()) return;
    const FittedNetwork& made = fit_.fitted();
    active_ = made;
    ++fits_;
    innovation_ = fast_ = shared_[0] = shared_[1] = {};
    return;
  }
  if (kept_ < next_fit_) return;
  next_fit_ = 4 * kept_;
  for (std::size_t k = 0; k < kRing; ++k) rows_.values[k] = recent_[(kept_ + k) % kRing];
  fit_.begin(rows_, kRing - kRoom - kPastHeldOut, kPastHeldOut, seed_);
}

bool PastNetwork::pays(double variance) {
  const double c = std::min(shared_[0].mean, shared_[1].mean) -
                   kPastErrors * std::max(shared_[0].error(kSlow), shared_[1].error(kSlow));
  const double s = std::max(innovation_.mean, fast_.mean);
  gain_ = c > 0 && s > 0 ? std::min(1.0, c / s) : 0;
  // Of x - gain e: what it pays is judged by the lower limit, what it is by the middle. c is the variance itself.
  const double shared = std::min((shared_[0].mean + shared_[1].mean) / 2, variance);
  variance_ = std::max(variance - gain_ * (2 * shared - gain_ * std::max(s, variance)), kLeastLeft * variance);
  return innovation_.count >= kSettled && variance > 0 && gain_ * c > (leads_ ? kPaysNoMore : kPays) * variance;
}

bool PastNetwork::judge(double x, double variance, const double* half, const double* weight) {
  if (!std::isfinite(x)) {
    fused_.seen = half_[0].seen = half_[1].seen = 0;
    kept_ = 0;
    leads_ = false;
    reason_ = HandOverReason::missing;
    return false;
  }
  const bool halves = weight[0] > 0 && weight[1] > 0 && half_[0].full() && half_[1].full();
  const bool known = active_.fitted() && fused_.full() && halves;
  bool good = false;
  if (known) {
    const double e = x - predicted(fused_);
    const double apart = kPastSigmas * std::sqrt(std::max(innovation_.mean, fast_.mean));
    const bool near = innovation_.count < kSettled || std::abs(e) <= apart;
    leads_ = pays(variance);
    good = leads_ && near;
    if (!leads_) reason_ = HandOverReason::no_gain;
    if (leads_ && !near) reason_ = HandOverReason::apart;
    z_ = x - gain_ * e;
    innovation_.add(e * e, kSlow);
    fast_.add(e * e, kQuick);
    for (int a = 0; a < 2; ++a)
      shared_[a].add(weight[a] * (half[a] - half[1 - a]) * (half[a] - predicted(half_[a])), kSlow);
  } else {
    leads_ = false;
    reason_ = HandOverReason::missing;
  }
  calm_ = good ? std::min(calm_ + 1, kPastCalm) : 0;
  keep(x);
  for (int a = 0; a < 2; ++a) {
    if (weight[a] > 0)
      half_[a].push(half[a]);
    else
      half_[a].seen = 0;
  }
  adapt();
  if (calm_ == kPastCalm) reason_ = HandOverReason::right;
  return calm_ == kPastCalm;
}

}  // namespace libchar::fusion

#include "libchar/simulate/fault.hpp"

#include <algorithm>
#include <cmath>

namespace libchar {
namespace {

// First sample at or after `t`; one that stands there but for rounding counts.
double first_sample(double t, double rate_hz) { return std::ceil(t * rate_hz - 1e-6); }

}  // namespace

FaultInjector::FaultInjector(std::vector<SensorFault> faults, double rate_hz, std::uint64_t seed, std::uint64_t sensor)
    : faults_(std::move(faults)), rate_hz_(rate_hz) {
  // Every noise fault has a stream of its own, so that one more fault changes no other.
  for (std::size_t i = 0; i < faults_.size(); ++i)
    noise_.emplace_back(StreamKey{seed, sensor * 4096 + i, Purpose::fault});
}

void FaultInjector::apply(std::span<double> y) {
  if (faults_.empty()) return;
  for (double& sample : y) {
    const auto k = static_cast<double>(done_++);
    bool stuck = false;
    const double healthy = sample;
    for (std::size_t i = 0; i < faults_.size(); ++i) {
      const SensorFault& fault = faults_[i];
      if (k < first_sample(fault.from_s, rate_hz_) || k >= first_sample(fault.to_s, rate_hz_)) continue;
      switch (fault.kind) {
        case FaultKind::scale:
          sample *= fault.value;
          break;
        case FaultKind::bias:
          sample += fault.value;
          break;
        case FaultKind::ramp:
          sample += fault.value * (k / rate_hz_ - fault.from_s);
          break;
        case FaultKind::stuck:
          sample = std::isnan(last_) ? healthy : last_;
          if (std::isnan(last_)) last_ = healthy;
          stuck = true;
          break;
        case FaultKind::saturation:
          sample = std::clamp(sample, -std::abs(fault.value), std::abs(fault.value));
          break;
        case FaultKind::noise:
          sample += fault.value * noise_[i].normal();
          break;
        case FaultKind::dropout:
          sample = std::numeric_limits<double>::quiet_NaN();
          break;
      }
    }
    if (!stuck && !std::isnan(sample)) last_ = sample;
  }
}

}  // namespace libchar

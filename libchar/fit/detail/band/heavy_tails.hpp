#pragma once
// The interval of white noise whose samples are not Gaussian.

#include <cstdint>

#include "libchar/fit/fit_result.hpp"

namespace libchar {

/// Widens the interval and covariance of the white noise by what heavy tails add, and says so; nothing where the kurtosis of first
/// differences is below `spike_alarm(samples)`, as of Gaussian noise. `samples` without the missing ones.
void widen_for_tails(double difference_kurtosis, std::uint64_t samples, NoiseFit& fit);

}  // namespace libchar

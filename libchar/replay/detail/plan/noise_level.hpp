#pragma once
// How noisy one sample of a modelled sensor is: what weights are made of.

#include <cstdint>

#include "libchar/model/sensor_model.hpp"

namespace libchar {

/// Variance of one output sample's fast noise, in the output's unit squared, of a sensor sampled at
/// `rate_hz` whose model runs at oversampling x rate_hz, as `simulate` runs it:
///   white and quantization noise    their stationary variance behind the low-pass
///   flicker and random walk, which have none: their Allan variance at one output sample
///   rounding to the resolution      step^2 / 12
/// Bias, ramp and temperature are no noise. Throws Error(usage) when rate or oversampling is not
/// positive or the model's noise makes no sense (band-limited without a bandwidth).
double sample_noise_variance(const SensorModel& model, double rate_hz, std::uint64_t oversampling = 1);

}  // namespace libchar

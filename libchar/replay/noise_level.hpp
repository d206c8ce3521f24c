#pragma once
#include "libchar/model/sensor_model.hpp"
#include <cstdint>
namespace libchar { double sample_noise_variance(const SensorModel&, double rate_hz, std::uint64_t oversampling); }

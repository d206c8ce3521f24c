#pragma once
#include <string>

#include "libchar/fit/noise_fit.hpp"
#include "libchar/log/recording.hpp"

namespace sensorchar {

/// One channel's noise coefficients as a table for people, with what was done to the data and what to think of the fit.
std::string fit_for_people(const libchar::Channel& channel, const libchar::NoiseFit& fit);

}  // namespace sensorchar

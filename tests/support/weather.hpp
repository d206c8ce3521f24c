#pragma once
// Temperatures and what they do to a sensor, apart from the library's simulator.

#include <cmath>
#include <vector>

#include "libchar/fit/signs/temperature.hpp"
#include "tests/support/noise.hpp"

namespace test {

/// Shapes of a temperature in degC: what sensors see.
enum class Weather { drifting, daily, warming, ramp, cycling };

inline libchar::TemperatureRecord weather(Weather kind, std::size_t n, Gaussian& gauss) {
  libchar::TemperatureRecord out{"temp", "°C", std::vector<double>(n)};
  const double phase = 6.28 * gauss.uniform();
  double walk = 0;
  for (std::size_t t = 0; t < n; ++t) {
    const double x = static_cast<double>(t) / static_cast<double>(n);
    walk += gauss() / std::sqrt(static_cast<double>(n));
    double value = 25;
    if (kind == Weather::drifting) value += 3 * walk;
    if (kind == Weather::daily) value += 5 * std::sin(2 * 6.2832 * x + phase) + 0.5 * walk;
    if (kind == Weather::warming) value += 10 * (1 - std::exp(-6 * x)) + 0.3 * walk;
    if (kind == Weather::ramp) value += 8 * x + 0.2 * walk;
    if (kind == Weather::cycling) value += std::sin(20 * 6.2832 * x + phase) + 0.2 * walk;
    out.samples[t] = std::round((value + 0.02 * gauss()) / 0.01) * 0.01;
  }
  return out;
}

/// What a sensor with these coefficients makes of a temperature.
inline void add_effect(std::vector<double>& y, const libchar::TemperatureRecord& temperature, double rate_hz,
                       double lag_s, double one, double two = 0) {
  double mean = 0;
  for (const double x : temperature.samples) mean += x / static_cast<double>(y.size());
  double state = temperature.samples[0];
  for (std::size_t t = 0; t < y.size(); ++t) {
    state = lag_s > 0 ? state + (temperature.samples[t] - state) / (lag_s * rate_hz) : temperature.samples[t];
    y[t] += one * (state - mean) + two * (state - mean) * (state - mean);
  }
}

}  // namespace test

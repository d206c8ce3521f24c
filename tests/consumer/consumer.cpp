#include <cstdio>
#include <vector>

#include "libchar/libchar.hpp"

int main() {
  const std::vector<double> ramp = {0, 1, 2, 3, 4, 5, 6, 7};
  const libchar::AllanCurve curve = libchar::allan_deviation(ramp, 1.0);
  libchar::SensorModel model;
  model.noise[0].value = 0.1;
  libchar::SimulateOptions options;
  options.rate_hz = 100;
  options.duration_s = 100;
  const libchar::Recording recording = libchar::simulate(model, options);
  const libchar::NoiseFit fit = libchar::fit(recording.channel(0), options.rate_hz);
  // A ramp of slope 1: tau / sqrt 2. The white noise that was put in, to a digit.
  std::printf(
      "%.6f %.1f\n", curve.points.at(0).deviation, fit[libchar::Term::white].value.value_or(0));
}

// Three devices of one model; one of them gets stuck. The truth is the last channel.
#include <cstdio>

#include "libchar/libchar.hpp"

int main() {
  const auto model = libchar::parse_sensor_model(
      "format: sensor-model\nversion: 1\nchannel: gyro\nunit: deg/s\nrate_hz: 200\n"
      "density: one-sided\nwhite_noise: {value: 0.005, unit: deg/s/sqrt(Hz)}\n"
      "bias_instability: 0.002\n",
      "gyro.sensor.yaml");

  libchar::SimulateOptions options;
  options.duration_s = 60;
  options.devices = 3;
  options.truth.kind = "sine";
  options.truth.amplitude = 10;
  options.faults = {{.sensor = 1, .kind = libchar::FaultKind::stuck, .from_s = 40, .to_s = 50}};
  const libchar::Recording recording = libchar::simulate(model, options);
  for (std::size_t c = 0; c < recording.samples.size(); ++c)
    std::printf("%s %.4f\n", recording.info.channels[c].name.c_str(), recording.channel(c)[9000]);
  libchar::write_recording("library-gyros.csv", recording, {.overwrite = true});
}

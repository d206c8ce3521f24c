// Sensor models for the program that consumes them; `export_targets()` lists the targets.
#include <cstdio>
#include <string>
#include <vector>

#include "libchar/libchar.hpp"

int main() {
  std::vector<libchar::SensorModel> models;
  const std::string head = "format: sensor-model\nversion: 1\nrate_hz: 200\n";
  for (const std::string noise : {"channel: gyro\nunit: rad/s\nwhite_noise: 1.7e-4\nrandom_walk: 1.9e-5\n",
                                  "channel: accel\nunit: m/s^2\nwhite_noise: 2.0e-3\nrandom_walk: 3.0e-3\n"})
    models.push_back(libchar::parse_sensor_model(head + "density: two-sided\n" + noise, "data sheet"));

  libchar::ExportOptions options;
  options.topic = "/imu";
  const libchar::Export made = libchar::export_models("kalibr", models, options);
  std::fputs(made.text.c_str(), stdout);
}

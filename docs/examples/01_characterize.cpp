// A log in, a noise model out: what `sensorchar characterize` does.
#include <cstdio>

#include "libchar/libchar.hpp"

int main() {
  libchar::CharacterizeOptions options;
  options.reading.channels = {"gyro_z"};  // all channels when empty
  const auto result = libchar::characterize("fixtures/imu_at_rest.csv", options);
  for (const libchar::ChannelResult& c : result.channels) {
    if (!c.fit) continue;  // c.findings says why
    const libchar::Coefficient& n = (*c.fit)[libchar::Term::white];
    std::printf("%s: N %.3g %s·√s, 95 %% from %.3g to %.3g\n", c.channel.name.c_str(), *n.value, c.channel.unit.c_str(),
                n.ci95.low, n.ci95.high);
  }
  libchar::write_whole_file("library-report.html", libchar::html_report(result), true);
  for (const libchar::SensorModel& model : libchar::sensor_models(result))
    libchar::write_whole_file("library-gyro_z.sensor.yaml", libchar::model_yaml(model), true);
}

#pragma once
// Six models of one IMU for the tests of exports.

#include <string>
#include <vector>

#include "libchar/export/exports.hpp"

namespace test {

inline libchar::Coefficient known(double value) {
  libchar::Coefficient c;
  c.status = libchar::Status::detected;
  c.value = value;
  c.ci95 = {0.9 * value, 1.1 * value};
  return c;
}

inline libchar::Coefficient at_most(double limit) {
  libchar::Coefficient c;
  c.status = libchar::Status::not_detected;
  c.upper95 = limit;
  return c;
}

struct Levels {
  libchar::Coefficient q, b, k;
};

inline libchar::SensorModel model(const std::string& channel, const std::string& unit, const Levels& levels,
                                  double rate_hz = 200) {
  libchar::SensorModel m;
  m.channel = channel;
  m.unit = unit;
  m.rate_hz = rate_hz;
  m.noise[0] = levels.q;
  m.noise[1] = levels.b;
  m.noise[2] = levels.k;
  m.recording.file = "imu.csv";
  m.recording.sha256 = std::string(64, 'a');
  m.obtained = "fit of a recording";
  m.duration_s = 7200;
  m.tau_min_s = 0.005;
  m.tau_max_s = 1500;
  return m;
}

/// gyr_x … acc_z, in rad/s and m/s^2 unless said otherwise.
inline std::vector<libchar::SensorModel> imu(const Levels& gyroscope, const Levels& accelerometer, double rate_hz = 200,
                                             const std::string& gyroscope_unit = "rad/s",
                                             const std::string& accelerometer_unit = "m/s^2") {
  std::vector<libchar::SensorModel> out;
  for (const char* axis : {"x", "y", "z"}) {
    out.push_back(model(std::string("gyr_") + axis, gyroscope_unit, gyroscope, rate_hz));
    out.push_back(model(std::string("acc_") + axis, accelerometer_unit, accelerometer, rate_hz));
  }
  return out;
}

/// The numbers of the EuRoC data sets (ADIS16448; Burri et al. 2016).
inline std::vector<libchar::SensorModel> euroc_imu() {
  return imu({known(1.6968e-4), at_most(2e-5), known(1.9393e-5)}, {known(2.0e-3), at_most(2e-4), known(3.0e-3)});
}

inline libchar::Export exported(const std::string& target, const std::vector<libchar::SensorModel>& models,
                                const libchar::ExportOptions& options = {}) {
  return libchar::export_models(libchar::find_export_target(target), models, options);
}

inline bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The number behind `key` and one of ": ", ">", " = …* ", "', ", " " in a file of any target.
double number_after(const std::string& text, const std::string& key);

}  // namespace test

// gnss-ins-sim: the dictionary for IMU(accuracy=…). White noise in deg/sqrt(h) and m/s/sqrt(h); the
// bias is a Gauss-Markov process by its steady standard deviation and correlation time. An infinite
// correlation time would turn it into white noise, so it is finite even where there is no bias.
// Only the constructor converts deg/h: set_gyro_error() takes the same words without converting.

#include <fmt/format.h>

#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

struct GnssInsSimWriter {
  const ExportOptions& options;
  Export& out;

  void line(const std::string& key, const std::array<double, 3>& values, const std::string& comment) {
    out.text += fmt::format("    '{}': np.array({}),  # {}\n", key, export_list(values), comment_text(comment));
  }

  void white(const SensorTriad& triad, double rate_hz = 0) {
    const RowOfAxes row = white_of_axes("gnss-ins-sim", triad, Absent::zero, options, out.notes, {.rate_hz = rate_hz});
    line(row.key, row.values, row.comment);
  }

  void bias(const std::string& name, const SensorTriad& triad, double factor, const char* unit) {
    const BiasOfAxes of = bias_of_axes(triad, options, factor, name + "_b_stability", out.notes);
    std::array<double, 3> constant{};
    for (std::size_t i = 0; i < 3; ++i) constant[i] = of.model[i]->bias.value * of.to_unit[i];
    line(name + "_b", constant, fmt::format("{}, constant; 0 unless stated", unit));
    line(name + "_b_stability", of.steady_sd, unit_and_origin(unit, of.origins));
    line(name + "_b_corr", of.correlation_s, "s; finite: with inf the bias would be white noise");
  }
};

Export write_gnss_ins_sim(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  GnssInsSimWriter writer{options, out};
  out.text = commented(head_lines(group, options,
                                  "arw = white_noise 60 180/pi, vrw = white_noise 60, b_stability = steady standard "
                                  "deviation of a Gauss-Markov bias"),
                       "# ");
  out.text +=
      "# For the constructor only: imu_model.IMU(accuracy=imu_err, axis=6). set_gyro_error() does not convert units.\n"
      "# Releases before the correction of issue 19 scale b_stability by 1/fs: take a later one.\n"
      "import numpy as np\n\nimu_err = {\n";
  require_axes(*group.gyroscope, only_axis(options));
  require_axes(*group.accelerometer, only_axis(options));
  writer.bias("gyro", *group.gyroscope, 3600 * kDegreesPerRadian, "deg/h");
  writer.white(*group.gyroscope);
  writer.bias("accel", *group.accelerometer, 1, "m/s^2");
  writer.white(*group.accelerometer);
  if (group.magnetometer) {
    const double rate = rate_of(*group.magnetometer, out.notes);
    writer.white(*group.magnetometer, rate);
  }
  out.text += "}\n";
  return out;
}

}  // namespace

ExportTarget gnss_ins_sim_target() {
  return {"gnss-ins-sim",
          "gnss-ins-sim",
          "deg/sqrt(h), m/s/sqrt(h); a Gauss-Markov bias by its steady standard deviation in deg/h, m/s^2",
          "imu_err.py",
          ExportNeeds::gyroscope_and_accelerometer,
          "NBK",
          {.magnetometer = true, .gauss_markov = true},
          write_gnss_ins_sim};
}

}  // namespace libchar

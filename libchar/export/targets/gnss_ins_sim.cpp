// gnss-ins-sim: the dictionary for IMU(accuracy=…). White noise in deg/sqrt(h) and m/s/sqrt(h); the
// bias is a Gauss-Markov process by its steady standard deviation and correlation time. An infinite
// correlation time would turn it into white noise, so it is finite even where there is no bias.
// Only the constructor converts deg/h: set_gyro_error() takes the same words without converting.

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_targets.hpp"
#include "libchar/export/detail/export_text.hpp"

namespace libchar {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

std::string with_unit(const char* unit, const std::string& origin) {
  return origin.empty() ? unit : fmt::format("{}; {}", unit, origin);
}

struct Writer {
  const ExportOptions& options;
  Export& out;

  void line(const std::string& key,
            const std::array<double, 3>& values,
            const std::string& comment) {
    out.text += fmt::format(
        "    '{}': np.array({}),  # {}\n", key, export_list(values), comment_text(comment));
  }

  void white(const std::string& key, const SensorTriad& triad, double factor, const char* unit) {
    const auto figures = axis_figures(triad, Term::white, Absent::zero, options);
    std::array<double, 3> values{};
    std::array<std::string, 3> origins;
    for (std::size_t i = 0; i < 3; ++i) {
      values[i] = value_or_zero(figures[i]) * factor;
      note_figure(out.notes, key, figures[i]);
      origins[i] = figures[i].origin;
    }
    line(key, values, with_unit(unit, axis_origins(origins)));
  }

  void bias(const std::string& name, const SensorTriad& triad, double factor, const char* unit) {
    const bool one = options.axes != AxisChoice::automatic;
    std::array<double, 3> constant{}, stability{}, correlation{};
    std::array<std::string, 3> origins;
    for (std::size_t i = 0; i < 3; ++i) {
      const PlacedModel& placed = one ? representative(triad, options) : *triad.axis[i];
      const GaussMarkov process =
          one ? gauss_markov_scalar(triad, options) : gauss_markov(placed, options);
      constant[i] = placed.model->bias.value * placed.to_si * factor;
      stability[i] = process.steady_sd * factor;
      correlation[i] = process.correlation_s;
      origins[i] = process.origin;
      if (process.driving == 0)
        out.notes.push_back(
            fmt::format("{}_b_stability {}: 0 ({})", name, "xyz"[i], process.origin));
    }
    line(name + "_b", constant, fmt::format("{}, constant; 0 unless stated", unit));
    line(name + "_b_stability", stability, with_unit(unit, axis_origins(origins)));
    line(name + "_b_corr", correlation, "s; finite: with inf the bias would be white noise");
  }
};

}  // namespace

Export export_gnss_ins_sim(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  Writer writer{options, out};
  out.text = commented(head_lines(group,
                                  options,
                                  "arw = white_noise 60 180/pi, vrw = white_noise 60, b_stability "
                                  "= steady standard deviation of a Gauss-Markov bias"),
                       "# ");
  out.text +=
      "# For the constructor only: imu_model.IMU(accuracy=imu_err, axis=6). set_gyro_error() does "
      "not convert units.\n"
      "# Releases before the correction of issue 19 scale b_stability by 1/fs: take a later one.\n"
      "import numpy as np\n\nimu_err = {\n";
  require_axes(*group.gyroscope, only_axis(options));
  require_axes(*group.accelerometer, only_axis(options));
  writer.bias("gyro", *group.gyroscope, 3600 * kDegrees, "deg/h");
  writer.white("gyro_arw", *group.gyroscope, 60 * kDegrees, "deg/sqrt(h)");
  writer.bias("accel", *group.accelerometer, 1, "m/s^2");
  writer.white("accel_vrw", *group.accelerometer, 60, "m/s/sqrt(h)");
  if (group.magnetometer) {
    const double rate = rate_of(*group.magnetometer, out.notes);
    writer.white("mag_std", *group.magnetometer, 1e6 * std::sqrt(rate), "uT, of a sample (axis=9)");
  }
  out.text += "}\n";
  return out;
}

}  // namespace libchar

// Covariances of sensor_msgs/Imu (and MagneticField), row by row: the variance of one sample, Q^2
// f. A first element of -1 says that a quantity is not provided; a matrix of zeros would say that
// its covariance is unknown.

#include <fmt/format.h>

#include <cmath>

#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_targets.hpp"
#include "libchar/export/detail/export_text.hpp"

namespace libchar {
namespace {

const char* const kNotProvided = "[-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]";

std::string covariance(const char* key,
                       const std::optional<SensorTriad>& triad,
                       const char* unit,
                       const ExportOptions& options,
                       Export& out) {
  if (!triad) {
    out.notes.push_back(fmt::format("{}: -1 first, that is not provided; no model was given", key));
    return fmt::format("{}: {}  # not provided\n", key, kNotProvided);
  }
  const double rate = rate_of(*triad, out.notes);
  const Figure largest = positive_figure(*triad, Term::white, options, "ROS", key);
  std::array<double, 3> variance{};
  std::array<std::string, 3> origins;
  const auto figures = axis_figures(*triad, Term::white, Absent::limit, options);
  for (std::size_t i = 0; i < 3; ++i) {
    const Figure& figure = figures[i].value ? figures[i] : largest;
    variance[i] = *figure.value * *figure.value * rate;
    if (figure.limit) note_figure(out.notes, key, figure);
    origins[i] = figure.origin;
  }
  const std::string comment = axis_origins(origins);
  return fmt::format("{}: [{}, 0.0, 0.0, 0.0, {}, 0.0, 0.0, 0.0, {}]  # {}, at {} Hz{}{}\n",
                     key,
                     export_number(variance[0]),
                     export_number(variance[1]),
                     export_number(variance[2]),
                     unit,
                     export_number(rate),
                     comment.empty() ? "" : "; ",
                     comment);
}

}  // namespace

Export export_ros(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  out.text = commented(
      head_lines(group, options, "variance of a sample = white_noise^2 f (row major, x y z)"),
      "# ");
  out.text += "# Samples averaged n to 1 before publishing have 1/n of these variances.\n";
  out.text += fmt::format(
      "orientation_covariance: {}  # not provided: no attitude in this device's noise\n",
      kNotProvided);
  out.text += covariance("angular_velocity_covariance", group.gyroscope, "(rad/s)^2", options, out);
  out.text +=
      covariance("linear_acceleration_covariance", group.accelerometer, "(m/s^2)^2", options, out);
  if (group.magnetometer)
    out.text += covariance("magnetic_field_covariance",
                           group.magnetometer,
                           "T^2, of sensor_msgs/MagneticField",
                           options,
                           out);
  return out;
}

}  // namespace libchar

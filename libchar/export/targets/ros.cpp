// Covariances of sensor_msgs/Imu (and MagneticField), row by row: the variance of one sample, N^2 f. A first element of
// -1 says that a quantity is not provided; a matrix of zeros would say that its covariance is unknown.

#include <fmt/format.h>

#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

const char* const kNotProvided = "[-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]";

std::string covariance(const char* sensor, const std::optional<SensorTriad>& triad, const ExportOptions& options,
                       Export& out) {
  const ConsumerRow& row = row_of("ros", sensor, Term::white);
  const std::string key(row.key);
  if (!triad) {
    out.notes.push_back(fmt::format("{}: -1 first, that is not provided; no model was given", key));
    return fmt::format("{}: {}  # not provided\n", key, kNotProvided);
  }
  const double rate = rate_of(*triad, out.notes);
  const ExportFigure largest = positive_figure(*triad, Term::white, options, "ROS", key);
  std::array<double, 3> variance{};
  std::array<std::string, 3> origins;
  const auto figures = axis_figures(*triad, Term::white, Absent::limit, options);
  for (std::size_t i = 0; i < 3; ++i) {
    const ExportFigure& figure = figures[i].value ? figures[i] : largest;
    variance[i] = row_value(row, *figure.value, {.rate_hz = rate});
    if (figure.limit) note_figure(out.notes, key, figure);
    origins[i] = figure.origin;
  }
  const std::string unit = fmt::format("{}, at {} Hz", file_unit(row), export_number(rate));
  return fmt::format("{}: [{}, 0.0, 0.0, 0.0, {}, 0.0, 0.0, 0.0, {}]  # {}\n", key, export_number(variance[0]),
                     export_number(variance[1]), export_number(variance[2]),
                     unit_and_origin(unit, axis_origins(origins)));
}

Export write_ros(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  out.text = commented(head_lines(group, options, "variance of a sample = white_noise^2 f (row major, x y z)"), "# ");
  out.text += "# Samples averaged n to 1 before publishing have 1/n of these variances.\n";
  out.text +=
      fmt::format("orientation_covariance: {}  # not provided: no attitude in this device's noise\n", kNotProvided);
  out.text += covariance("gyroscope", group.gyroscope, options, out);
  out.text += covariance("accelerometer", group.accelerometer, options, out);
  if (group.magnetometer) out.text += covariance("magnetometer", group.magnetometer, options, out);
  return out;
}

}  // namespace

ExportTarget ros_target() {
  return {"ros",
          "ROS sensor_msgs",
          "variance of a sample: N^2 f on the diagonal, one for each axis",
          "imu_covariance.yaml",
          ExportNeeds::gyroscope_or_accelerometer,
          "N",
          {.magnetometer = true},
          write_ros};
}

}  // namespace libchar

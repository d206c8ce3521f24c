// Kalibr imu.yaml. Read with PyYAML: a %YAML line is a parse error, and a number without a decimal point before its
// exponent is text. Kalibr refuses a value that is not > 0, and divides the densities by sqrt(1/update_rate) itself.

#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

Export write_kalibr(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  const ImuFigures f = imu_figures(group, options, "Kalibr", out.notes);
  out.text = commented(head_lines(group, options,
                                  "density = white_noise, walk = random_walk (roots of two-sided, continuous "
                                  "densities; Kalibr makes them discrete itself)"),
                       "# ");
  out.text += "rostopic: " + topic_scalar(group, options) + "\n";
  out.text += yaml_line("update_rate", f.gyroscope_rate_hz, "Hz", "");
  out.text += row_lines("kalibr", f);
  return out;
}

// The sensor.yaml of a EuRoC data set: the same four numbers, in a data set folder.
Export write_euroc(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  const ImuFigures f = imu_figures(group, options, "a EuRoC data set", out.notes);
  out.text =
      commented(head_lines(group, options,
                           "density = white_noise, walk = random_walk (roots of two-sided, continuous densities)"),
                "# ");
  out.text +=
      "sensor_type: imu\n"
      "comment: noise by sensorchar\n"
      "T_BS:  # pose of the sensor in the body frame: not known from a recording at rest\n"
      "  cols: 4\n  rows: 4\n"
      "  data: [1.0, 0.0, 0.0, 0.0,\n"
      "         0.0, 1.0, 0.0, 0.0,\n"
      "         0.0, 0.0, 1.0, 0.0,\n"
      "         0.0, 0.0, 0.0, 1.0]\n";
  out.text += yaml_line("rate_hz", f.gyroscope_rate_hz, "Hz", "");
  out.text += row_lines("kalibr", f);
  out.notes.emplace_back("T_BS is the identity: a recording at rest does not say where the sensor sits");
  return out;
}

}  // namespace

ExportTarget kalibr_target() {
  return {"kalibr",
          "Kalibr",
          "continuous densities: N in rad/s/sqrt(Hz), m/s^2/sqrt(Hz); K in rad/s^2/sqrt(Hz), m/s^3/sqrt(Hz); all > 0",
          "imu.yaml",
          ExportNeeds::gyroscope_and_accelerometer,
          "NK",
          {.topic = true},
          write_kalibr};
}

ExportTarget euroc_target() {
  return {"euroc",
          "EuRoC data sets",
          "continuous densities: N and K as for Kalibr",
          "sensor.yaml",
          ExportNeeds::gyroscope_and_accelerometer,
          "NK",
          {},
          write_euroc};
}

}  // namespace libchar

// Kalibr imu.yaml. Read with PyYAML: a %YAML line is a parse error, and a number without a decimal
// point before its exponent is text. Kalibr refuses a value that is not > 0, and divides the
// densities by sqrt(1/update_rate) itself.

#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_targets.hpp"
#include "libchar/export/detail/export_text.hpp"

namespace libchar {

Export export_kalibr(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  const ImuFigures f = imu_figures(group, options, "Kalibr", out.notes);
  out.text = commented(head_lines(group,
                                  options,
                                  "density = white_noise, walk = random_walk (roots of two-sided, "
                                  "continuous densities; Kalibr makes them discrete itself)"),
                       "# ");
  out.text += "rostopic: " + topic_scalar(options.topic) + "\n";
  out.text += yaml_line("update_rate", f.gyroscope_rate_hz, "Hz", "");
  out.text += density_lines(f);
  return out;
}

}  // namespace libchar

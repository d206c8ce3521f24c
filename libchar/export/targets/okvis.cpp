// OKVIS and OKVIS2: imu_parameters of its configuration, in OpenCV's dialect of YAML. The covariance grows by dt
// sigma^2 a step: continuous densities N and K (smartroboticslab/okvis2 0f18f34, okvis_ceres/src/ImuError.cpp). a_max
// and g_max are where it takes a reading for saturated and trusts it a hundred times less: those of the sensor.

#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

/// Where the sensor saturates, where its model says so.
void add_range(const char* key, const SensorTriad& triad, const ExportOptions& options, Export& out) {
  const PlacedModel& placed = representative(triad, options);
  const std::optional<double>& high = placed.model->saturation_high;
  if (high)
    out.text += "    " + yaml_line(key, *high * placed.to_si, triad.si_unit, "saturation");
  else
    out.notes.push_back(std::string(key) + " is left out: the model names no saturation");
}

Export write_okvis(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  const ImuFigures f = imu_figures(group, options, "OKVIS", out.notes);
  out.text = "%YAML:1.0\n";
  out.text += commented(
      head_lines(group, options,
                 "sigma_g_c, sigma_a_c = white_noise; sigma_gw_c, sigma_aw_c = random_walk (continuous densities)"),
      "# ");
  out.text += "imu_parameters:\n" + row_lines("okvis", f, "    ");
  add_range("a_max", *group.accelerometer, options, out);
  add_range("g_max", *group.gyroscope, options, out);
  if (options.gravity) out.text += "    " + yaml_line("g", *options.gravity, "m/s^2", "");
  return out;
}

}  // namespace

ExportTarget okvis_target() {
  return {"okvis",
          "OKVIS, OKVIS2",
          "continuous densities: N and K; OpenCV YAML",
          "okvis_imu.yaml",
          ExportNeeds::gyroscope_and_accelerometer,
          "NK",
          {.gravity = true},
          write_okvis};
}

}  // namespace libchar

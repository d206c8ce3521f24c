// LIO-SAM's params.yaml. It squares the white numbers into GTSAM's covariances, which are continuous, and gives
// the bias between two scans the standard deviation w sqrt(t), t the time between them: all four are continuous
// densities, N and K (TixiaoShan/LIO-SAM 041f4e6, src/imuPreintegration.cpp).

#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

Export write_lio_sam(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  const ImuFigures f = imu_figures(group, options, "LIO-SAM", out.notes);
  out.text = commented(
      head_lines(group, options,
                 "imuAccNoise, imuGyrNoise = white_noise; imuAccBiasN, imuGyrBiasN = random_walk (densities)"),
      "# ");
  // Parameters of ROS 2 stand below a node's name, those of ROS 1 below the program's.
  out.text += options.older ? "lio_sam:\n" : "/**:\n  ros__parameters:\n";
  const std::string indent = options.older ? "  " : "    ";
  out.text += indent + "imuTopic: " + topic_scalar(group, options) + "\n";
  out.text += row_lines("lio-sam", f, indent);
  if (options.gravity) out.text += indent + yaml_line("imuGravity", *options.gravity, "m/s^2", "");
  return out;
}

}  // namespace

ExportTarget lio_sam_target() {
  return {"lio-sam",
          "LIO-SAM",
          "continuous densities: N and K, which it squares itself; YAML of ROS parameters",
          "params.yaml",
          ExportNeeds::gyroscope_and_accelerometer,
          "NK",
          {.gravity = true, .topic = true, .older = true},
          write_lio_sam};
}

}  // namespace libchar

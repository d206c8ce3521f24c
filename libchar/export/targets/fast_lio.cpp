// FAST-LIO and FAST-LIO2. The filter adds (dt f_w) Q (dt f_w)^T a step, so a step of dt adds dt^2 q to the
// variance of the angle and of the velocity, and a second adds dt q; white noise of density N adds N^2:
//   acc_cov, gyr_cov = N^2 / dt = N^2 f,   b_acc_cov, b_gyr_cov = K^2 / dt = K^2 f.
// They are variances, of a sample and at one rate. Accelerations are scaled to 9.81 m/s^2 by its own initialization,
// and are in m/s^2 (hku-mars/FAST_LIO 1087a72, src/IMU_Processing.hpp, include/IKFoM_toolkit/esekfom/esekfom.hpp).

#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

Export write_fast_lio(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  const ImuFigures f = imu_figures(group, options, "FAST-LIO", out.notes);
  out.text =
      commented(head_lines(group, options,
                           "acc_cov, gyr_cov = white_noise^2 f; b_acc_cov, b_gyr_cov = random_walk^2 f (f: IMU rate)"),
                "# ");
  out.text +=
      commented({"Variances, not standard deviations, and right at this IMU rate only: the filter multiplies them by",
                 "dt^2 a step. The values of its examples (0.1, 0.0001) are far above those of a sensor at rest."},
                "# ");
  out.text += "common:\n  imu_topic: " + topic_scalar(group, options) + "\nmapping:\n";
  out.text += row_lines("fast-lio", f, "  ");
  return out;
}

}  // namespace

ExportTarget fast_lio_target() {
  return {"fast-lio",
          "FAST-LIO, FAST-LIO2",
          "variances per sample, as its filter reads them: N^2 f and K^2 f",
          "fast_lio.yaml",
          ExportNeeds::gyroscope_and_accelerometer,
          "NK",
          {.topic = true},
          write_fast_lio};
}

}  // namespace libchar

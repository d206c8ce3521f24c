// ROVIO's rovio.info and maplab's sensor file, which stand side by side in the same projects and disagree: ROVIO's
// numbers are covariances, squares of continuous densities (noise / sqrt(dt) on the readings, noise sqrt(dt) on the
// biases: ethz-asl/rovio 02a665c, include/rovio/ImuPrediction.hpp); its "att" is the gyroscope and "vel" the
// accelerometer. maplab's sigmas are the densities themselves, all > 0 (ethz-asl/maplab, sensors/imu.h).

#include <fmt/format.h>

#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

Export write_rovio(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  const ImuFigures f = imu_figures(group, options, "ROVIO", out.notes);
  out.text =
      commented(head_lines(group, options, "att, vel = white_noise^2; gyb, acb = random_walk^2 (covariances)"), "; ");
  out.text += "Prediction\n{\n    PredictionNoise\n    {\n";
  for (const char* sensor : {"accelerometer", "gyroscope"})
    for (const Term term : {Term::white, Term::walk}) {
      const ConsumerRow& row = row_of("rovio", sensor, term);
      for (const int axis : {0, 1, 2})
        out.text += fmt::format("        {}_{} {};    {}\n", row.key, axis,
                                export_number(row_value(row, *figure_of(f, sensor, term).value)), file_unit(row));
    }
  out.text += "    }\n}\n";
  return out;
}

Export write_maplab(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  const ImuFigures f = imu_figures(group, options, "maplab", out.notes);
  out.text = commented(
      head_lines(group, options, "noise_density = white_noise, bias_random_walk = random_walk (continuous densities)"),
      "# ");
  out.text += "topic: " + topic_scalar(group, options) + "\nsigmas:\n" + row_lines("maplab", f, "  ");
  return out;
}

}  // namespace

ExportTarget rovio_target() {
  return {"rovio",
          "ROVIO",
          "continuous covariances: N^2 and K^2, att of the gyroscope, vel of the accelerometer",
          "rovio_imu.info",
          ExportNeeds::gyroscope_and_accelerometer,
          "NK",
          {},
          write_rovio};
}

ExportTarget maplab_target() {
  return {"maplab",
          "maplab",
          "continuous densities: N and K, all > 0",
          "imu-maplab.yaml",
          ExportNeeds::gyroscope_and_accelerometer,
          "NK",
          {.topic = true},
          write_maplab};
}

}  // namespace libchar

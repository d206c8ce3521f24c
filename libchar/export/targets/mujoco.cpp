// MuJoCo's sensors: `noise` is the standard deviation of a sample. Until 3.1.3 the simulator added it where the
// flag sensornoise was on; since 3.1.4 it only keeps the number, and who reads the sensor adds it (XML reference
// of google-deepmind/mujoco, sensor).

#include <fmt/format.h>

#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

std::string mujoco_sensor(const char* element, const SensorTriad& triad, const ExportOptions& options, Export& out) {
  const double rate = rate_of(triad, out.notes);
  const ExportFigure white = scalar_figure(triad, Term::white, Absent::zero, options);
  note_figure(out.notes, triad.kind + ": noise", white);
  const ConsumerRow& row = row_of("mujoco", triad.kind, Term::white);
  const double sd = row_value(row, value_or_zero(white), {.rate_hz = rate});
  return fmt::format("    <{0} name=\"{0}\" site=\"imu\" noise=\"{1}\"/>  <!-- {2}, at {3} Hz only -->\n", element,
                     export_number(sd), file_unit(row), export_number(rate));
}

Export write_mujoco(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  std::string sensors;
  if (group.gyroscope) sensors += mujoco_sensor("gyro", *group.gyroscope, options, out);
  if (group.accelerometer) sensors += mujoco_sensor("accelerometer", *group.accelerometer, options, out);
  out.text = "<!--\n";
  out.text += commented(head_lines(group, options, "noise = white_noise sqrt(f), of a sample"), "  ");
  out.text +=
      "  MuJoCo 3.1.4 and later do not add this noise: add it where you read the sensor. A bias that moves has no "
      "place here.\n-->\n<mujoco>\n  <sensor>\n" +
      sensors + "  </sensor>\n</mujoco>\n";
  out.notes.emplace_back("MuJoCo 3.1.4 and later do not add the noise: add it where you read the sensor");
  return out;
}

}  // namespace

ExportTarget mujoco_target() {
  return {"mujoco",
          "MuJoCo",
          "stddev of a sample N sqrt(f); later releases keep it and do not add it",
          "imu_sensors.xml",
          ExportNeeds::gyroscope_or_accelerometer,
          "N",
          {},
          write_mujoco};
}

}  // namespace libchar

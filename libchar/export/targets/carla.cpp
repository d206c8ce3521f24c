// CARLA's sensor.other.imu: a normal deviate on each reading, and a constant bias of the gyroscope
// (carla-simulator/carla 001f560, InertialMeasurementUnit.cpp). The standard deviation of a sample holds at one
// sensor_tick only; there is no bias of the accelerometer, and none that moves.

#include <fmt/format.h>

#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

void add_carla_triad(const SensorTriad& triad, const char* word, double rate_hz, const ExportOptions& options,
                     Export& out) {
  const auto white = axis_figures(triad, Term::white, Absent::zero, options);
  const ConsumerRow& row = row_of("carla", triad.kind, Term::white);
  for (std::size_t i = 0; i < 3; ++i) {
    note_figure(out.notes, fmt::format("{} {}: stddev", triad.kind, "xyz"[i]), white[i]);
    const double sd = row_value(row, value_or_zero(white[i]), {.rate_hz = rate_hz});
    out.text += fmt::format("    '{}_{}': {},  # {}\n", row.key, "xyz"[i], export_number(sd), file_unit(row));
  }
  const bool one = options.axes != AxisChoice::automatic;
  for (std::size_t i = 0; i < 3; ++i) {
    const PlacedModel& placed = one ? representative(triad, options) : *triad.axis[i];
    const double bias = placed.model->bias.value * placed.to_si;
    if (std::string_view(word) == "gyro")
      out.text += fmt::format("    'noise_gyro_bias_{}': {},  # rad/s\n", "xyz"[i], export_number(bias));
    else if (bias != 0)
      out.notes.push_back(fmt::format("accelerometer {}: CARLA has no bias for it", "xyz"[i]));
  }
}

Export write_carla(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  const double rate = rate_of(group.gyroscope ? *group.gyroscope : *group.accelerometer, out.notes);
  out.text = commented(head_lines(group, options, "stddev = white_noise sqrt(1 / sensor_tick)"), "# ");
  out.text += "imu_attributes = {\n";
  out.text +=
      fmt::format("    'sensor_tick': {},  # s; the stddev below hold at this one only\n", export_number(1 / rate));
  if (group.accelerometer) add_carla_triad(*group.accelerometer, "accel", rate, options, out);
  if (group.gyroscope) add_carla_triad(*group.gyroscope, "gyro", rate, options, out);
  out.text +=
      "}\n# blueprint = world.get_blueprint_library().find('sensor.other.imu')\n"
      "for key, value in imu_attributes.items():\n    blueprint.set_attribute(key, str(value))\n";
  return out;
}

}  // namespace

ExportTarget carla_target() {
  return {"carla",
          "CARLA",
          "stddev of a sample N sqrt(f) at one sensor_tick; a constant bias of the gyroscope",
          "carla_imu.py",
          ExportNeeds::gyroscope_or_accelerometer,
          "N",
          {},
          write_carla};
}

}  // namespace libchar

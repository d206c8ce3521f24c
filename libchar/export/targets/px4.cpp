// PX4 EKF2 and ArduPilot EK3: noise of the prediction step. A step dt adds (dt noise)^2 to the variance of an angle or
// a velocity and (dt bias_noise)^2 to that of a bias; white noise adds N^2 dt and a random walk K^2 dt:
//   noise = N / sqrt(dt),  bias_noise = K / sqrt(dt).

#include <fmt/format.h>

#include <array>

#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

// PX4's own values, in the order of its rows of the table.
constexpr std::array kGyroscopeDefaults = {"0.015", "0.001"};
constexpr std::array kAccelerometerDefaults = {"0.35", "0.003"};

void put(const SensorTriad& triad, const ConsumerRow& row, const char* px4_default, const ExportOptions& options,
         Export& out, std::string& px4, std::string& ardupilot) {
  const ConsumerRow& other = row_of("ardupilot", triad.kind, row.term);
  const ExportFigure figure = scalar_figure(triad, row.term, Absent::limit, options);
  note_figure(out.notes, row.key, figure);
  if (!figure.value) {
    px4 += fmt::format("# {} keeps its value: {}\n", row.key, comment_text(figure.origin));
    ardupilot += fmt::format("# {} keeps its value: {}\n", other.key, comment_text(figure.origin));
    return;
  }
  const std::string value = export_number(row_value(row, *figure.value, {.filter_step_s = options.filter_step_s}));
  px4 += fmt::format("# {}, PX4's default is {}{}{}\nparam set {} {}\n", file_unit(row), px4_default,
                     figure.origin.empty() ? "" : "; before conversion: ", comment_text(figure.origin), row.key, value);
  ardupilot += fmt::format("param set {} {}\n", other.key, value);
}

Export write_px4(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  std::string px4, ardupilot;
  const auto put_all = [&](const std::optional<SensorTriad>& triad, const auto& defaults) {
    if (!triad) return;
    const auto rows = rows_of("px4", triad->kind);
    for (std::size_t i = 0; i < rows.size(); ++i) put(*triad, *rows[i], defaults.at(i), options, out, px4, ardupilot);
  };
  put_all(group.gyroscope, kGyroscopeDefaults);
  put_all(group.accelerometer, kAccelerometerDefaults);
  out.text = commented(
      head_lines(
          group, options,
          fmt::format(
              "noise = white_noise / sqrt(dt), bias noise = random_walk / sqrt(dt), dt = {} s, the step of the filter",
              export_number(options.filter_step_s))),
      "# ");
  out.text +=
      "# A floor, not advice: vibration and what the filter does not model want ten times as much and more, and\n"
      "# the autopilots clip to their own ranges.\n"
      "# PX4 EKF2 (nsh):\n" +
      px4 + "# ArduPilot EK3 (MAVProxy):\n" + ardupilot;
  out.notes.emplace_back("these are the sensor's own noise at rest, a lower bound for the filter's numbers");
  return out;
}

}  // namespace

ExportTarget px4_target() {
  return {"px4",
          "PX4 EKF2, ArduPilot EK3",
          "per filter step dt: N / sqrt(dt), K / sqrt(dt); a lower bound, not a tuning",
          "ekf_params.txt",
          ExportNeeds::gyroscope_or_accelerometer,
          "NK",
          {.filter_step = true},
          write_px4};
}

}  // namespace libchar

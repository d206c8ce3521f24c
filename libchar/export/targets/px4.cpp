// PX4 EKF2 and ArduPilot EK3: noise of the prediction step. A step dt adds (dt noise)^2 to the
// variance of an angle or a velocity and (dt bias_noise)^2 to that of a bias; white noise adds Q^2
// dt and a random walk K^2 dt:
//   noise = Q / sqrt(dt),  bias_noise = K / sqrt(dt).

#include <fmt/format.h>

#include <cmath>

#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_targets.hpp"
#include "libchar/export/detail/export_text.hpp"

namespace libchar {
namespace {

struct Parameter {
  const char* px4;
  const char* ardupilot;
  Term term;
  const char* unit;
  const char* px4_default;
};

void put(const SensorTriad& triad,
         const Parameter& p,
         const ExportOptions& options,
         Export& out,
         std::string& px4,
         std::string& ardupilot) {
  const Figure figure = scalar_figure(triad, p.term, Absent::limit, options);
  note_figure(out.notes, p.px4, figure);
  if (!figure.value) {
    px4 += fmt::format("# {} keeps its value: {}\n", p.px4, comment_text(figure.origin));
    ardupilot +=
        fmt::format("# {} keeps its value: {}\n", p.ardupilot, comment_text(figure.origin));
    return;
  }
  const std::string value = export_number(*figure.value / std::sqrt(options.filter_step_s));
  px4 += fmt::format("# {}, PX4's default is {}{}{}\nparam set {} {}\n",
                     p.unit,
                     p.px4_default,
                     figure.origin.empty() ? "" : "; before conversion: ",
                     comment_text(figure.origin),
                     p.px4,
                     value);
  ardupilot += fmt::format("param set {} {}\n", p.ardupilot, value);
}

}  // namespace

Export export_px4(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  std::string px4, ardupilot;
  if (group.gyroscope) {
    put(*group.gyroscope,
        {"EKF2_GYR_NOISE", "EK3_GYRO_P_NSE", Term::white, "rad/s", "0.015"},
        options,
        out,
        px4,
        ardupilot);
    put(*group.gyroscope,
        {"EKF2_GYR_B_NOISE", "EK3_GBIAS_P_NSE", Term::walk, "rad/s^2", "0.001"},
        options,
        out,
        px4,
        ardupilot);
  }
  if (group.accelerometer) {
    put(*group.accelerometer,
        {"EKF2_ACC_NOISE", "EK3_ACC_P_NSE", Term::white, "m/s^2", "0.35"},
        options,
        out,
        px4,
        ardupilot);
    put(*group.accelerometer,
        {"EKF2_ACC_B_NOISE", "EK3_ABIAS_P_NSE", Term::walk, "m/s^3", "0.003"},
        options,
        out,
        px4,
        ardupilot);
  }
  out.text =
      commented(head_lines(group,
                           options,
                           fmt::format("noise = white_noise / sqrt(dt), bias noise = random_walk / "
                                       "sqrt(dt), dt = {} s, the step of the filter",
                                       export_number(options.filter_step_s))),
                "# ");
  out.text +=
      "# A floor, not advice: vibration and what the filter does not model want ten times as much "
      "and more, and\n"
      "# the autopilots clip to their own ranges.\n"
      "# PX4 EKF2 (nsh):\n" +
      px4 + "# ArduPilot EK3 (MAVProxy):\n" + ardupilot;
  out.notes.emplace_back(
      "these are the sensor's own noise at rest, a lower bound for the filter's numbers");
  return out;
}

}  // namespace libchar

// The dictionary of Pegasus' IMU(config) for Isaac Sim: white noise by its continuous density (the code divides by
// sqrt(dt)), and an exact Ornstein-Uhlenbeck step of driving density random_walk (extensions/…/logic/sensors/imu.py of
// PegasusSimulator). At its commit 2c99164 the gyroscope's step takes the accelerometer's correlation time, the
// accelerometer's draws uniform numbers, and neither bias is added to what comes out.

#include <fmt/format.h>

#include <algorithm>

#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

std::string pegasus_line(const char* key, double value, const std::string& comment) {
  return fmt::format("        \"{}\": {},  # {}\n", key, export_number(value), comment_text(comment));
}

std::string pegasus_sensor(const SensorTriad& triad, const char* unit, const ExportOptions& options, Export& out) {
  const ExportFigure white = scalar_figure(triad, Term::white, Absent::zero, options);
  const GaussMarkov bias = gauss_markov_scalar(triad, options);
  const ConsumerRow& row = row_of("pegasus", triad.kind, Term::white);
  note_figure(out.notes, fmt::format("{} noise_density", triad.kind), white);
  if (bias.driving == 0) out.notes.push_back(fmt::format("{} random_walk: 0 ({})", triad.kind, bias.origin));
  const PlacedModel& placed = representative(triad, options);
  return fmt::format("    \"{}\": {{\n", triad.kind) +
         pegasus_line("noise_density", row_value(row, value_or_zero(white)),
                      unit_and_origin(file_unit(row), white.origin)) +
         pegasus_line("random_walk", bias.driving,
                      fmt::format("{}/s/sqrt(Hz), driving density; {}", unit, bias.origin)) +
         pegasus_line("bias_correlation_time", bias.correlation_s, "s") +
         pegasus_line("turn_on_bias_sigma", placed.model->bias.spread * placed.to_si,
                      fmt::format("{}; 0 unless stated", unit)) +
         "    },\n";
}

Export write_pegasus(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  const double rate = std::max(rate_of(*group.gyroscope, out.notes), rate_of(*group.accelerometer, out.notes));
  out.text = commented(head_lines(group, options,
                                  "noise_density = white_noise (root of the two-sided density); random_walk = driving "
                                  "density q of a Gauss-Markov bias"),
                       "# ");
  out.text +=
      "# For IMU(config=imu_config). Pegasus at commit 2c99164 steps the gyroscope's bias with the accelerometer's\n"
      "# correlation time and adds neither bias to its output: look at logic/sensors/imu.py of your release.\n";
  out.text += "imu_config = {\n";
  out.text += pegasus_sensor(*group.gyroscope, "rad/s", options, out);
  out.text += pegasus_sensor(*group.accelerometer, "m/s^2", options, out);
  out.text += fmt::format("    \"update_rate\": {},  # Hz\n}}\n", export_number(rate));
  return out;
}

}  // namespace

ExportTarget pegasus_target() {
  return {"pegasus",
          "Pegasus for Isaac Sim",
          "continuous densities: N, and a Gauss-Markov bias by its driving density and correlation time",
          "imu_config.py",
          ExportNeeds::gyroscope_and_accelerometer,
          "NBK",
          {.gauss_markov = true},
          write_pegasus};
}

}  // namespace libchar

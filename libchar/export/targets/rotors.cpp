// Parameters of the Gazebo IMU plugins of RotorS, PX4 Gazebo classic and UUV: white noise by its continuous density
// (the code divides by sqrt(dt)), and an exact Ornstein-Uhlenbeck step for the bias. The code reads
// gyroscopeBiasRandomWalk while its own models write gyroscopeRandomWalk (which is ignored, so that the default stays):
// both are written here. Correlation times have to be > 0.

#include <fmt/format.h>

#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

std::string parameter(const std::string& key, double value, const std::string& comment) {
  return fmt::format("  <{0}>{1}</{0}>  <!-- {2} -->\n", key, export_number(value), comment_text(comment));
}

std::string triad_block(const SensorTriad& triad, const char* unit, const ExportOptions& options, Export& out) {
  const std::string name = triad.kind;
  const ExportFigure white = scalar_figure(triad, Term::white, Absent::zero, options);
  const GaussMarkov bias = gauss_markov_scalar(triad, options);
  const ConsumerRow& row = row_of("rotors", name, Term::white);
  note_figure(out.notes, row.key, white);
  if (bias.driving == 0) out.notes.push_back(name + "RandomWalk: 0 (" + bias.origin + ")");
  std::string text = parameter(std::string(row.key), row_value(row, value_or_zero(white)),
                               unit_and_origin(file_unit(row), white.origin));
  const std::string driving = fmt::format("{}/s/sqrt(Hz); {}", unit, bias.origin);
  if (name == "gyroscope")
    text += parameter("gyroscopeBiasRandomWalk", bias.driving, "the key that the code reads; " + driving);
  text += parameter(name + "RandomWalk", bias.driving, driving);
  text += parameter(name + "BiasCorrelationTime", bias.correlation_s, "s");
  const PlacedModel& placed = representative(triad, options);
  text +=
      parameter(name + "TurnOnBiasSigma", placed.model->bias.spread * placed.to_si,
                fmt::format("{}; the spread between two switchings on is not in one recording, 0 unless stated", unit));
  return text;
}

Export write_rotors(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  out.text = "<?xml version=\"1.0\"?>\n<!--\n";
  out.text += commented(head_lines(group, options,
                                   "NoiseDensity = white_noise (root of the two-sided density); RandomWalk = driving "
                                   "density q of a Gauss-Markov bias"),
                        "  ");
  out.text +=
      "  The defaults of the plugins are an ADIS16448 with its noise doubled: leave none of these keys out.\n-->\n";
  out.text += "<plugin name=\"rotors_gazebo_imu_plugin\" filename=\"librotors_gazebo_imu_plugin.so\">\n";
  out.text += triad_block(*group.gyroscope, "rad/s", options, out);
  out.text += triad_block(*group.accelerometer, "m/s^2", options, out);
  out.text += "</plugin>\n";
  out.notes.emplace_back("robotNamespace, linkName and imuTopic of the plugin stay yours");
  return out;
}

}  // namespace

ExportTarget rotors_target() {
  return {"rotors",
          "RotorS, PX4 Gazebo classic, UUV",
          "continuous densities: N, and a Gauss-Markov bias by its driving density and correlation time",
          "imu_plugin.xml",
          ExportNeeds::gyroscope_and_accelerometer,
          "NBK",
          {.gauss_markov = true},
          write_rotors};
}

}  // namespace libchar

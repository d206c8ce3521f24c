// Webots' Gyro and Accelerometer: one lookupTable for three axes, whose third column is noise relative to the reading
// (cyberbotics/webots 1039893, WbLookupTable.cpp: reading (1 + noise Gaussian), both columns linear in between). A
// table of one noise is silent at rest. Here the noise of row i is sd / |reading|, at readings that grow by a constant
// ratio, so that their product is the sd of a sample to half a per cent everywhere; a bias of sd / 50 keeps a true
// zero out of the few readings around 0 where it is less.

#include <fmt/format.h>

#include <cmath>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

constexpr double kRatio = 1.2;
/// Between two readings the product of two straight lines is up to (1 + q)^2 / 4q too large: half of that is taken off.
constexpr double kMiddle = (1 + (1 + kRatio) * (1 + kRatio) / (4 * kRatio)) / 2;
constexpr double kBiasShare = 0.02, kFirstShare = 0.005;

std::string lookup_rows(double sd, double range) {
  const double first = kFirstShare * sd;
  const auto steps = clamped_whole<int>(std::ceil(std::log(range / first) / std::log(kRatio)));
  std::string out;
  const auto add = [&](double reading) {
    out += fmt::format("    {} {} {}\n", export_number(reading - kBiasShare * sd), export_number(reading),
                       export_number(sd / std::abs(reading) / kMiddle));
  };
  for (int k = steps; k >= 0; --k) add(-first * std::pow(kRatio, k));
  for (int k = 0; k <= steps; ++k) add(first * std::pow(kRatio, k));
  return out;
}

/// `range`: beyond it the simulator holds the last reading.
void add_webots_node(const char* node, const char* name, double range, const SensorTriad& triad,
                     const ExportOptions& options, Export& out) {
  const double rate = rate_of(triad, out.notes);
  const ExportFigure white = scalar_figure(triad, Term::white, Absent::zero, options);
  note_figure(out.notes, triad.kind + ": lookupTable", white);
  const ConsumerRow& row = row_of("webots", triad.kind, Term::white);
  const double sd = row_value(row, value_or_zero(white), {.rate_hz = rate});
  const std::string unit = file_unit(row);
  out.text += fmt::format("# {}: stddev of a sample {} {}, at a sampling period of {} ms only; range {} {}\n", node,
                          export_number(sd), unit, export_number(1000 / rate), export_number(range), unit);
  out.text += fmt::format("{} {{\n  name \"{}\"\n", node, name);
  if (sd > 0) out.text += "  lookupTable [\n" + lookup_rows(sd, range) + "  ]\n";
  out.text += "}\n";
  for (const std::optional<PlacedModel>& placed : triad.axis)
    if (placed && placed->model->bias.value != 0)
      out.notes.push_back(triad.kind + ": one table serves three axes, so its bias is left out");
}

Export write_webots(const SensorGroup& group, const ExportOptions& options) {
  constexpr double kFastestTurn = 100, kStrongestPush = 1000;  // rad/s, m/s^2
  Export out;
  out.text = commented(head_lines(group, options, "noise = white_noise sqrt(f) / |reading|, row by row"), "# ");
  out.text +=
      "# Webots multiplies the noise by the reading: these rows undo it. A bias that moves has no place here.\n";
  if (group.gyroscope) add_webots_node("Gyro", "gyro", kFastestTurn, *group.gyroscope, options, out);
  if (group.accelerometer)
    add_webots_node("Accelerometer", "accelerometer", kStrongestPush, *group.accelerometer, options, out);
  return out;
}

}  // namespace

ExportTarget webots_target() {
  return {"webots",
          "Webots",
          "stddev of a sample N sqrt(f), in a table of noise relative to the reading, which Webots multiplies by it",
          "imu_sensors.wbt",
          ExportNeeds::gyroscope_or_accelerometer,
          "N",
          {},
          write_webots};
}

}  // namespace libchar

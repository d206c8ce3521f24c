// SDFormat <noise> as Gazebo applies it: a white number a sample (stddev, discrete: right at one
// update rate only) and a Gauss-Markov bias by its continuous driving density and correlation time.
// Gazebo draws the constant bias at load and turns its sign with probability 1/2, so a known offset
// belongs into <mean>; releases of ign-sensors before the dynamic bias ignore dynamic_bias_*.

#include <fmt/format.h>

#include "libchar/core/refusal.hpp"
#include "libchar/core/units.hpp"
#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

std::string noise_element(const std::string& sensor, const PlacedModel& placed, const ExportFigure& white,
                          const GaussMarkov& bias, double rate_hz, const std::string& pad) {
  const SensorModel& m = *placed.model;
  std::string out = pad + "<noise type=\"gaussian\">\n";
  const auto line = [&](std::string_view key, double value) {
    out += fmt::format("{}  <{}>{}</{}>\n", pad, key, export_number(value), key);
  };
  line("mean", m.bias.value * placed.to_si);
  const ConsumerRow& row = row_of("sdf", sensor, Term::white);
  line(row.key, row_value(row, value_or_zero(white), {.rate_hz = rate_hz}));
  line("bias_mean", 0);
  line("bias_stddev", m.bias.spread * placed.to_si);
  if (bias.driving > 0) {
    line("dynamic_bias_stddev", bias.driving);
    line("dynamic_bias_correlation_time", bias.correlation_s);
  }
  out += fmt::format("{}  <!-- {}{} -->\n", pad,
                     white.origin.empty() ? "" : comment_text("stddev: " + white.origin) + "; ",
                     comment_text("bias: " + bias.origin));
  return out + pad + "</noise>\n";
}

std::string triad_element(const char* element, const SensorTriad& triad, const ExportOptions& options, Export& out) {
  const double rate = rate_of(triad, out.notes);
  const auto white = axis_figures(triad, Term::white, Absent::zero, options);
  const bool one = options.axes != AxisChoice::automatic;
  std::string text = fmt::format("      <{}>\n", element);
  for (std::size_t i = 0; i < 3; ++i) {
    const PlacedModel& placed = one ? representative(triad, options) : *triad.axis[i];
    const GaussMarkov bias = one ? gauss_markov_scalar(triad, options) : gauss_markov(placed, options);
    note_figure(out.notes, fmt::format("{} {}: stddev", triad.kind, "xyz"[i]), white[i]);
    if (bias.driving == 0)
      out.notes.push_back(fmt::format("{} {}: no dynamic bias ({})", triad.kind, "xyz"[i], bias.origin));
    text += fmt::format("        <{}>\n", "xyz"[i]);
    text += noise_element(triad.kind, placed, white[i], bias, rate, "          ");
    text += fmt::format("        </{}>\n", "xyz"[i]);
  }
  return text + fmt::format("      </{}>\n", element);
}

std::string sensor_element(const char* type, double rate_hz, const std::string& inside) {
  return fmt::format(
      "  <sensor name=\"{0}_sensor\" type=\"{0}\">\n    <always_on>1</always_on>\n"
      "    <update_rate>{1}</update_rate>  <!-- the stddev below holds at this rate only -->\n{2}  </sensor>\n",
      type, export_number(rate_hz), inside);
}

std::string barometer_element(const SensorModel& m, const ExportOptions& options, Export& out) {
  const auto unit = find_unit(m.unit);
  SensorTriad triad{"barometer", "Pa", {}, true};
  if (!unit || unit->quantity != Quantity::pressure)
    throw input_error("E0583", m.channel)
        .says("its unit is not one of pressure, which a barometer needs")
        .got(m.unit)
        .hint("write unit: Pa into the model file");
  triad.axis.fill(PlacedModel{&m, unit->to_si});
  const double rate = rate_of(triad, out.notes);
  const ExportFigure white = scalar_figure(triad, Term::white, Absent::zero, options);
  note_figure(out.notes, "barometer: stddev", white);
  return sensor_element(
      "air_pressure", rate,
      "    <air_pressure>\n      <pressure>\n" +
          noise_element(triad.kind, *triad.axis[0], white, gauss_markov(*triad.axis[0], options), rate, "        ") +
          "      </pressure>\n    </air_pressure>\n");
}

Export write_sdf(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  std::string sensors, imu;
  if (group.gyroscope) imu += triad_element("angular_velocity", *group.gyroscope, options, out);
  if (group.accelerometer) imu += triad_element("linear_acceleration", *group.accelerometer, options, out);
  if (!imu.empty()) {
    const double rate = rate_of(group.gyroscope ? *group.gyroscope : *group.accelerometer, out.notes);
    sensors += sensor_element("imu", rate, "    <imu>\n" + imu + "    </imu>\n");
  }
  if (group.magnetometer) {
    const double rate = rate_of(*group.magnetometer, out.notes);
    std::string inside = triad_element("magnetometer", *group.magnetometer, options, out);
    sensors += sensor_element("magnetometer", rate, inside);
  }
  for (const SensorModel* m : group.others) {
    if (kind_of(*m) == "barometer")
      sensors += barometer_element(*m, options, out);
    else
      out.notes.push_back(
          fmt::format("{}: SDFormat has no noise element for a {}; left out", comment_text(m->channel), kind_of(*m)));
  }
  if (sensors.empty())
    throw input_error("E0593")
        .says(
            "SDFormat has noise elements for gyroscopes, accelerometers, magnetometers and barometers, and none of "
            "these was given")
        .hint("where name and unit do not say what a channel is: `axis` NAME=gx");
  out.text = "<?xml version=\"1.0\"?>\n<!--\n";
  out.text += commented(
      head_lines(group, options,
                 "stddev = white_noise sqrt(update_rate); dynamic bias: driving density q of a Gauss-Markov process"),
      "  ");
  out.text +=
      "  bias_stddev is the spread from one switching on to the next: one recording does not show it, 0 unless "
      "stated.\n"
      "  precision is left out: the noise of rounding is part of white_noise already.\n-->\n";
  out.text += "<link name=\"sensors_link\">\n" + sensors + "</link>\n";
  return out;
}

}  // namespace

ExportTarget sdf_target() {
  return {"sdf",
          "SDFormat, Gazebo",
          "stddev of a sample N sqrt(f); a Gauss-Markov bias by its continuous driving density",
          "imu.sdf",
          ExportNeeds::any_sensor,
          "NBK",
          {.gauss_markov = true},
          write_sdf};
}

}  // namespace libchar

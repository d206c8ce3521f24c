// VINS-Mono and VINS-Fusion. Their integration takes the two ends of each midpoint step as
// independent: a step of dt adds to the velocity
//   var = 2 (dt/2)^2 acc_n^2 = dt^2 acc_n^2 / 2,
// so n steps of a second add (dt/2) acc_n^2, while white noise of density N adds N^2:
//   acc_n = N sqrt(2/dt) = N sqrt(2 f).
// The bias moves by acc_w dt a step (variance acc_w^2 dt^2, acc_w^2 dt a second) and by K a second:
//   acc_w = K / sqrt(dt) = K sqrt(f).

#include <fmt/format.h>

#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

Export write_vins(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  const ImuFigures f = imu_figures(group, options, "VINS", out.notes);
  out.text = "%YAML:1.0\n";
  out.text += commented(
      head_lines(group, options, "acc_n, gyr_n = white_noise sqrt(2 f); acc_w, gyr_w = random_walk sqrt(f)"), "# ");
  out.text += commented(
      {"Why these factors (f: rate of the IMU messages, dt = 1/f): the midpoint integration takes the two",
       "ends of a step as independent, so a step adds dt^2 n^2 / 2 to the variance of the velocity and a",
       "second adds dt n^2 / 2; white noise of density N adds N^2 a second, hence n = N sqrt(2 f). A bias step",
       "has the variance dt^2 w^2, a second dt w^2; a random walk has K^2 a second, hence w = K sqrt(f).",
       "Put these lines into your configuration, which begins with %YAML:1.0 itself."},
      "# ");
  const auto line = [&](const char* sensor, Term term, double rate, std::string how) {
    const ConsumerRow& row = row_of("vins", sensor, term);
    const ExportFigure& figure = figure_of(f, sensor, term);
    if (!figure.origin.empty()) how += "; " + figure.origin;
    out.text += yaml_line(row.key, row_value(row, *figure.value, {.rate_hz = rate}), file_unit(row), how);
  };
  const double fa = f.accelerometer_rate_hz, fg = f.gyroscope_rate_hz;
  const std::string a = export_number(fa), g = export_number(fg);
  line("accelerometer", Term::white, fa, fmt::format("white_noise sqrt(2*{})", a));
  line("gyroscope", Term::white, fg, fmt::format("white_noise sqrt(2*{})", g));
  line("accelerometer", Term::walk, fa, fmt::format("random_walk sqrt({})", a));
  line("gyroscope", Term::walk, fg, fmt::format("random_walk sqrt({})", g));
  if (options.gravity) out.text += yaml_line("g_norm", *options.gravity, "m/s^2", "");
  return out;
}

}  // namespace

ExportTarget vins_target() {
  return {"vins",
          "VINS-Mono, VINS-Fusion",
          "per sample, as its code reads them: acc_n, gyr_n = N sqrt(2 f); acc_w, gyr_w = K sqrt(f); OpenCV YAML",
          "imu_vins.yaml",
          ExportNeeds::gyroscope_and_accelerometer,
          "NK",
          {.gravity = true},
          write_vins};
}

}  // namespace libchar

// VINS-Mono and VINS-Fusion. Their integration takes the two ends of each midpoint step as
// independent: a step of dt adds to the velocity
//   var = 2 (dt/2)^2 acc_n^2 = dt^2 acc_n^2 / 2,
// so n steps of a second add (dt/2) acc_n^2, while white noise of density Q adds Q^2:
//   acc_n = Q sqrt(2/dt) = Q sqrt(2 f).
// The bias moves by acc_w dt a step (variance acc_w^2 dt^2, acc_w^2 dt a second) and by K a second:
//   acc_w = K / sqrt(dt) = K sqrt(f).

#include <fmt/format.h>

#include <cmath>

#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_targets.hpp"
#include "libchar/export/detail/export_text.hpp"

namespace libchar {

Export export_vins(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  const ImuFigures f = imu_figures(group, options, "VINS", out.notes);
  out.text = "%YAML:1.0\n";
  out.text += commented(
      head_lines(group,
                 options,
                 "acc_n, gyr_n = white_noise sqrt(2 f); acc_w, gyr_w = random_walk sqrt(f)"),
      "# ");
  out.text +=
      commented({"Why these factors (f: rate of the IMU messages, dt = 1/f): the midpoint "
                 "integration takes the two",
                 "ends of a step as independent, so a step adds dt^2 n^2 / 2 to the variance of "
                 "the velocity and a",
                 "second adds dt n^2 / 2; white noise of density Q adds Q^2 a second, hence n = Q "
                 "sqrt(2 f). A bias step",
                 "has the variance dt^2 w^2, a second dt w^2; a random walk has K^2 a second, "
                 "hence w = K sqrt(f).",
                 "Put these lines into your configuration, which begins with %YAML:1.0 itself."},
                "# ");
  const auto line =
      [&](const char* key, const Figure& figure, double factor, const char* unit, std::string how) {
        if (!figure.origin.empty()) how += "; " + figure.origin;
        out.text += yaml_line(key, *figure.value * factor, unit, how);
      };
  const double fa = f.accelerometer_rate_hz, fg = f.gyroscope_rate_hz;
  const std::string a = export_number(fa), g = export_number(fg);
  line("acc_n",
       f.accelerometer_white,
       std::sqrt(2 * fa),
       "m/s^2",
       fmt::format("white_noise sqrt(2*{})", a));
  line("gyr_n",
       f.gyroscope_white,
       std::sqrt(2 * fg),
       "rad/s",
       fmt::format("white_noise sqrt(2*{})", g));
  line("acc_w",
       f.accelerometer_walk,
       std::sqrt(fa),
       "m/s^3",
       fmt::format("random_walk sqrt({})", a));
  line("gyr_w", f.gyroscope_walk, std::sqrt(fg), "rad/s^2", fmt::format("random_walk sqrt({})", g));
  if (options.gravity) out.text += yaml_line("g_norm", *options.gravity, "m/s^2", "");
  return out;
}

}  // namespace libchar

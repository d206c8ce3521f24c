// GTSAM PreintegrationParams and PreintegrationCombinedParams: continuous covariances, the squares
// of the densities. A snippet, for that is what users paste.

#include <fmt/format.h>

#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_targets.hpp"
#include "libchar/export/detail/export_text.hpp"

namespace libchar {

Export export_gtsam(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  const ImuFigures f = imu_figures(group, options, "GTSAM", out.notes);
  out.text =
      commented(head_lines(group,
                           options,
                           "covariance = white_noise^2, random_walk^2 (two-sided, continuous "
                           "densities; GTSAM makes them discrete itself)"),
                "// ");
  if (options.gravity)
    out.text += fmt::format(
        "auto p = gtsam::PreintegrationCombinedParams::MakeSharedU({});  // m/s^2, z up\n",
        export_number(*options.gravity));
  else
    out.text += "// p: what PreintegrationCombinedParams::MakeSharedU(g) returned\n";
  const auto line = [&](const char* key, const Figure& figure, const char* unit) {
    out.text += fmt::format("p->{} = gtsam::I_3x3 * {};  // {}{}{}\n",
                            key,
                            export_number(*figure.value * *figure.value),
                            unit,
                            figure.origin.empty() ? "" : "; before squaring: ",
                            figure.origin);
  };
  line("gyroscopeCovariance", f.gyroscope_white, "(rad/s)^2/Hz");
  line("accelerometerCovariance", f.accelerometer_white, "(m/s^2)^2/Hz");
  line("biasOmegaCovariance", f.gyroscope_walk, "(rad/s^2)^2/Hz, combined factor only");
  line("biasAccCovariance", f.accelerometer_walk, "(m/s^3)^2/Hz, combined factor only");
  out.text +=
      "// integrationCovariance and biasAccOmegaInt describe the integration and the first bias, "
      "not the\n"
      "// sensor's noise: they stay yours.\n";
  return out;
}

}  // namespace libchar

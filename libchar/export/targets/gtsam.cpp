// GTSAM PreintegrationParams and PreintegrationCombinedParams: continuous covariances, the squares
// of the densities. A snippet, for that is what users paste.

#include <fmt/format.h>

#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

Export write_gtsam(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  const ImuFigures f = imu_figures(group, options, "GTSAM", out.notes);
  out.text = commented(head_lines(group, options,
                                  "covariance = white_noise^2, random_walk^2 (two-sided, continuous densities; GTSAM "
                                  "makes them discrete itself)"),
                       "// ");
  if (options.gravity)
    out.text += fmt::format("auto p = gtsam::PreintegrationCombinedParams::MakeSharedU({});  // m/s^2, z up\n",
                            export_number(*options.gravity));
  else
    out.text += "// p: what PreintegrationCombinedParams::MakeSharedU(g) returned\n";
  const auto line = [&](const ConsumerRow& row) {
    const ExportFigure& figure = figure_of(f, row.sensor, row.term);
    out.text +=
        fmt::format("p->{} = gtsam::I_3x3 * {};  // {}{}{}\n", row.key, export_number(row_value(row, *figure.value)),
                    file_unit(row), figure.origin.empty() ? "" : "; before squaring: ", figure.origin);
  };
  for (const Term term : {Term::white, Term::walk})
    for (const char* sensor : {"gyroscope", "accelerometer"}) line(row_of("gtsam", sensor, term));
  out.text +=
      "// integrationCovariance and biasAccOmegaInt describe the integration and the first bias, not the\n"
      "// sensor's noise: they stay yours.\n";
  return out;
}

}  // namespace

ExportTarget gtsam_target() {
  return {"gtsam",
          "GTSAM",
          "continuous covariances: N^2 and K^2",
          "imu_params.cpp",
          ExportNeeds::gyroscope_and_accelerometer,
          "NK",
          {.gravity = true},
          write_gtsam};
}

}  // namespace libchar

// The IMU block of an ORB-SLAM3 settings file. The code multiplies the noise by sqrt(IMU.Frequency)
// and divides the walks by it. With File.version "1.0" the frequency has to be a real number
// (200.0); the parser of older files takes whole numbers only (200).

#include <fmt/format.h>

#include <cmath>

#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

Export write_orbslam3(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  const ImuFigures f = imu_figures(group, options, "ORB-SLAM3", out.notes);
  out.text = "%YAML:1.0\n";
  out.text += commented(head_lines(group, options,
                                   "Noise = white_noise, Walk = random_walk (roots of two-sided, continuous densities; "
                                   "the code makes them discrete itself)"),
                        "# ");
  out.text += "# Put the IMU lines into your settings file, which begins with %YAML:1.0 itself.\n";
  if (!options.older) out.text += "File.version: \"1.0\"  # with it IMU.Frequency has to be a real number\n";
  for (const Term term : {Term::white, Term::walk})
    for (const char* sensor : {"gyroscope", "accelerometer"}) {
      const ConsumerRow& row = row_of("orbslam3", sensor, term);
      const ExportFigure& figure = figure_of(f, sensor, term);
      out.text += yaml_line(row.key, row_value(row, *figure.value), file_unit(row), figure.origin);
    }
  if (!options.older) {
    out.text += yaml_line("IMU.Frequency", f.gyroscope_rate_hz, "Hz", "");
    return out;
  }
  const double whole = std::round(f.gyroscope_rate_hz);
  out.text += fmt::format("IMU.Frequency: {:.0f}  # Hz; files without File.version take whole numbers only\n", whole);
  if (whole != f.gyroscope_rate_hz)
    out.notes.push_back(
        fmt::format("IMU.Frequency: {} Hz rounded to {:.0f}, for files without File.version take whole numbers only",
                    f.gyroscope_rate_hz, whole));
  return out;
}

}  // namespace

ExportTarget orbslam3_target() {
  return {"orbslam3",
          "ORB-SLAM3",
          "continuous densities: N and K, with the rate as a real number; OpenCV YAML",
          "imu_orbslam3.yaml",
          ExportNeeds::gyroscope_and_accelerometer,
          "NK",
          {.older = true},
          write_orbslam3};
}

}  // namespace libchar

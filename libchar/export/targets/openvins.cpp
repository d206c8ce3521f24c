// kalibr_imu_chain.yaml of OpenVINS: Kalibr's keys under imu0 with the intrinsics of its "kalibr"
// model, in OpenCV's dialect of YAML, whose first line has to be %YAML:1.0.

#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

std::string matrix(const char* key, int size, bool identity, const char* comment) {
  std::string out = std::string("  ") + key + ":" + comment + "\n";
  for (int row = 0; row < size; ++row) {
    out += "    - [";
    for (int column = 0; column < size; ++column) {
      out += column == 0 ? "" : ", ";
      out += identity && row == column ? "1.0" : "0.0";
    }
    out += "]\n";
  }
  return out;
}

Export write_openvins(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  const ImuFigures f = imu_figures(group, options, "OpenVINS", out.notes);
  out.text = "%YAML:1.0\n";
  out.text +=
      commented(head_lines(group, options,
                           "density = white_noise, walk = random_walk (roots of two-sided, continuous densities)"),
                "# ");
  out.text += "imu0:\n";
  out.text += matrix("T_i_b", 4, true, "");
  out.text += row_lines("kalibr", f, "  ");
  out.text += "  rostopic: " + topic_scalar(group, options) + "\n  time_offset: 0.0\n";
  out.text += "  " + yaml_line("update_rate", f.gyroscope_rate_hz, "Hz", "");
  out.text += "  model: \"kalibr\"\n";
  out.text += matrix("Tw", 3, true, "  # intrinsics: ideal, a recording at rest does not show them");
  out.text += matrix("R_IMUtoGYRO", 3, true, "");
  out.text += matrix("Ta", 3, true, "");
  out.text += matrix("R_IMUtoACC", 3, true, "");
  out.text += matrix("Tg", 3, false, "");
  out.notes.emplace_back("intrinsics and T_i_b are ideal: a recording at rest does not show them");
  return out;
}

}  // namespace

ExportTarget openvins_target() {
  return {"openvins",
          "OpenVINS",
          "continuous densities: N and K; OpenCV YAML",
          "kalibr_imu_chain.yaml",
          ExportNeeds::gyroscope_and_accelerometer,
          "NK",
          {.topic = true},
          write_openvins};
}

}  // namespace libchar

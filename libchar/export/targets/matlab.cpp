// MATLAB gyroparams, accelparams, magparams for imuSensor. With NoiseType double-sided the white
// noise has the standard deviation NoiseDensity sqrt(fs) a sample, with single-sided NoiseDensity
// sqrt(fs/2). BiasInstability is B itself; what was not found is left out (the default is 0).

#include <fmt/format.h>

#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

struct MatlabWriter {
  const ExportOptions& options;
  Export& out;

  // ",'Key',value" or ",'Key',[x y z]", or nothing when no axis has a value.
  std::string argument(const SensorTriad& triad, const ConsumerRow& row, std::string& comments) {
    const auto figures = axis_figures(triad, row.term, Absent::zero, options);
    std::array<double, 3> v{};
    for (std::size_t i = 0; i < 3; ++i) {
      v[i] = row_value(row, value_or_zero(figures[i]));
      const std::string origin = figures[i].origin.empty() ? "" : comment_text(figures[i].origin);
      const std::string line = fmt::format(
          "%   {}: {}\n", row.key,
          triad.shared || options.axes != AxisChoice::automatic ? origin : fmt::format("{} {}", "xyz"[i], origin));
      if (!origin.empty() && comments.find(line) == std::string::npos) comments += line;
    }
    if (v[0] == 0 && v[1] == 0 && v[2] == 0) {
      out.notes.push_back(fmt::format("{} of the {}: left out ({})", row.key, triad.kind, figures[0].origin));
      return "";
    }
    if (v[0] == v[1] && v[1] == v[2]) return fmt::format(", ...\n    '{}', {}", row.key, export_number(v[0]));
    return fmt::format(", ...\n    '{}', [{} {} {}]", row.key, export_number(v[0]), export_number(v[1]),
                       export_number(v[2]));
  }

  void block(const std::optional<SensorTriad>& triad, const char* name, const char* function, const char* unit) {
    if (!triad) return;
    require_axes(*triad, only_axis(options));
    std::string comments;
    std::string call = fmt::format("{} = {}('NoiseType', 'double-sided'", name, function);
    for (const ConsumerRow* row : rows_of("matlab", triad->kind)) call += argument(*triad, *row, comments);
    const ExportFigure white = scalar_figure(*triad, Term::white, Absent::zero, options);
    out.text +=
        fmt::format("% {}: NoiseDensity in ({})/sqrt(Hz), RandomWalk in ({})/s/sqrt(Hz), BiasInstability in {}\n",
                    function, unit, unit, unit);
    out.text += comments;
    out.text += fmt::format(
        "% Releases without NoiseType apply sqrt(fs/2): there NoiseDensity is sqrt(2) times as large, {}.\n",
        export_number(
            row_value(row_of("matlab", triad->kind, Term::white), 1.4142135623730951 * value_or_zero(white))));
    out.text += call + ");\n";
  }
};

Export write_matlab(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  MatlabWriter writer{options, out};
  out.text = commented(head_lines(group, options,
                                  "NoiseDensity = white_noise, RandomWalk = random_walk, BiasInstability = "
                                  "bias_instability (two-sided densities)"),
                       "% ");
  writer.block(group.gyroscope, "gyro", "gyroparams", "rad/s");
  writer.block(group.accelerometer, "accel", "accelparams", "m/s^2");
  writer.block(group.magnetometer, "mag", "magparams", "uT");
  return out;
}

}  // namespace

ExportTarget matlab_target() {
  return {"matlab",
          "MATLAB gyroparams, accelparams",
          "two-sided densities (NoiseType double-sided): N, K, and B itself",
          "imu_params.m",
          ExportNeeds::gyroscope_or_accelerometer,
          "NBK",
          {.magnetometer = true},
          write_matlab};
}

}  // namespace libchar

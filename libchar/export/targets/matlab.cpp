// MATLAB gyroparams, accelparams, magparams for imuSensor. With NoiseType double-sided the white
// noise has the standard deviation NoiseDensity sqrt(fs) a sample, with single-sided NoiseDensity
// sqrt(fs/2). BiasInstability is B itself; what was not found is left out (the default is 0).

#include <fmt/format.h>

#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_targets.hpp"
#include "libchar/export/detail/export_text.hpp"

namespace libchar {
namespace {

struct Writer {
  const ExportOptions& options;
  Export& out;

  // ",'Key',value" or ",'Key',[x y z]", or nothing when no axis has a value.
  std::string argument(
      const SensorTriad& triad, Term term, const char* key, double factor, std::string& comments) {
    const auto figures = axis_figures(triad, term, Absent::zero, options);
    std::array<double, 3> v{};
    for (std::size_t i = 0; i < 3; ++i) {
      v[i] = value_or_zero(figures[i]) * factor;
      const std::string origin = figures[i].origin.empty() ? "" : comment_text(figures[i].origin);
      const std::string line = fmt::format("%   {}: {}\n",
                                           key,
                                           triad.shared || options.axes != AxisChoice::automatic
                                               ? origin
                                               : fmt::format("{} {}", "xyz"[i], origin));
      if (!origin.empty() && comments.find(line) == std::string::npos) comments += line;
    }
    if (v[0] == 0 && v[1] == 0 && v[2] == 0) {
      out.notes.push_back(
          fmt::format("{} of the {}: left out ({})", key, triad.kind, figures[0].origin));
      return "";
    }
    if (v[0] == v[1] && v[1] == v[2])
      return fmt::format(", ...\n    '{}', {}", key, export_number(v[0]));
    return fmt::format(", ...\n    '{}', [{} {} {}]",
                       key,
                       export_number(v[0]),
                       export_number(v[1]),
                       export_number(v[2]));
  }

  void block(const std::optional<SensorTriad>& triad,
             const char* name,
             const char* function,
             double factor,
             const char* unit) {
    if (!triad) return;
    require_axes(*triad, only_axis(options));
    std::string comments;
    std::string call = fmt::format("{} = {}('NoiseType', 'double-sided'", name, function);
    call += argument(*triad, Term::white, "NoiseDensity", factor, comments);
    call += argument(*triad, Term::walk, "RandomWalk", factor, comments);
    call += argument(*triad, Term::flicker, "BiasInstability", factor, comments);
    const Figure white = scalar_figure(*triad, Term::white, Absent::zero, options);
    out.text += fmt::format(
        "% {}: NoiseDensity in ({})/sqrt(Hz), RandomWalk in ({})/s/sqrt(Hz), BiasInstability in "
        "{}\n",
        function,
        unit,
        unit,
        unit);
    out.text += comments;
    out.text += fmt::format(
        "% Releases without NoiseType apply sqrt(fs/2): there NoiseDensity is sqrt(2) times as "
        "large, {}.\n",
        export_number(1.4142135623730951 * value_or_zero(white) * factor));
    out.text += call + ");\n";
  }
};

}  // namespace

Export export_matlab(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  Writer writer{options, out};
  out.text = commented(head_lines(group,
                                  options,
                                  "NoiseDensity = white_noise, RandomWalk = random_walk, "
                                  "BiasInstability = bias_instability (two-sided densities)"),
                       "% ");
  writer.block(group.gyroscope, "gyro", "gyroparams", 1, "rad/s");
  writer.block(group.accelerometer, "accel", "accelparams", 1, "m/s^2");
  writer.block(group.magnetometer, "mag", "magparams", 1e6, "uT");
  return out;
}

}  // namespace libchar

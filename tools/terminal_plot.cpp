#include "terminal_plot.hpp"

#include <unistd.h>

#include <algorithm>
#include <vector>

#include "colour.hpp"
#include "libchar/figure/draw_figure.hpp"
#include "libchar/figure/make_figure.hpp"
#include "terminal.hpp"

namespace sensorchar {

std::string terminal_plots(std::span<const libchar::SourceCurve> curves) {
  using namespace libchar;
  // Curves of one unit and one statistic share axes, in the order of their first.
  std::vector<FigureSource> groups;
  for (const SourceCurve& curve : curves) {
    const bool drawable = std::any_of(curve.y.begin(), curve.y.end(), [](double y) { return y > 0; });
    if (!drawable) continue;
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const FigureSource& g) {
      return g.curves[0].unit == curve.unit && g.curves[0].statistic == curve.statistic;
    });
    if (group != groups.end()) {
      group->curves.push_back(curve);
    } else {
      groups.emplace_back().curves.push_back(curve);
    }
  }
  TerminalFigureOptions options;
  options.columns = columns_of_stdout().value_or(80);
  options.rows = std::clamp<std::size_t>(options.columns / 4, 12, 30);
  options.colour = colours(STDOUT_FILENO);
  std::string out;
  for (const FigureSource& group : groups) {
    FigureOptions wanted;
    wanted.kind = group.curves[0].is_allan ? "allan" : "psd";
    out += (out.empty() ? "" : "\n") + terminal_figure(make_figure({&group, 1}, wanted), options);
  }
  return out;
}

}  // namespace sensorchar

#include "libchar/report/detail/svg/svg_curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libchar/core/numeric/interval.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/svg/svg_frame.hpp"

namespace libchar {
namespace {

// Okabe & Ito: told apart by the colour-blind; dashes repeat more slowly than colours.
constexpr std::array<const char*, 7> kColours = {
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#7f7f7f"};
constexpr std::array<const char*, 4> kDashes = {"", "7 3", "2 3", "9 3 2 3"};

SvgFrame frame_of(const std::vector<SvgCurve>& curves) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Interval x{kInfinity, 0}, y{kInfinity, 0};
  for (const SvgCurve& c : curves)
    for (std::size_t i = 0; i < c.x.size(); ++i) {
      if (!drawable(c.x[i], c.y[i])) continue;
      x = {std::min(x.low, c.x[i]), std::max(x.high, c.x[i])};
      y = {std::min(y.low, c.y[i]), std::max(y.high, c.y[i])};
    }
  return svg_frame(x.low, x.high, y.low, y.high);
}

std::string stroke(const SvgCurve& c) {
  if (c.model) return "stroke=\"currentColor\" stroke-dasharray=\"6 4\" stroke-width=\"2\"";
  const std::string dash = kDashes[c.colour / kColours.size() % kDashes.size()];
  return fmt::format("stroke=\"{}\" stroke-width=\"{}\"{}",
                     kColours[c.colour % kColours.size()],
                     c.strong ? 3.2 : 1.4,
                     dash.empty() ? "" : " stroke-dasharray=\"" + dash + "\"");
}

std::string drawn(const SvgCurve& c, const SvgFrame& frame) {
  std::string points;
  for (std::size_t i = 0; i < c.x.size(); ++i)
    if (drawable(c.x[i], c.y[i]))
      points += fmt::format("{:.1f},{:.1f} ", frame.x.at(c.x[i]), frame.y.at(c.y[i]));
  return fmt::format("<polyline fill=\"none\" {} points=\"{}\"><title>{}</title></polyline>\n",
                     stroke(c),
                     points,
                     html_text(c.name));
}

/// One entry a look, in order of appearance.
std::string legend_of(const std::vector<SvgCurve>& curves, std::size_t most) {
  std::string out;
  std::vector<std::string> seen;
  for (const SvgCurve& c : curves) {
    if (std::find(seen.begin(), seen.end(), c.name) != seen.end()) continue;
    seen.push_back(c.name);
    if (seen.size() > most) continue;
    out += fmt::format(
        "<span class=\"key\"><svg width=\"26\" height=\"8\" aria-hidden=\"true\"><line x1=\"0\" "
        "y1=\"4\" "
        "x2=\"26\" y2=\"4\" {}/></svg> {}</span> ",
        stroke(c),
        html_text(c.name));
  }
  if (seen.size() > most)
    out += fmt::format("<span class=\"key\">and {} more</span>", seen.size() - most);
  return out;
}

}  // namespace

std::string svg_curves(const std::vector<SvgCurve>& curves, const SvgAxes& axes) {
  if (std::none_of(curves.begin(), curves.end(), [](const SvgCurve& c) {
        for (std::size_t i = 0; i < c.x.size(); ++i)
          if (drawable(c.x[i], c.y[i])) return true;
        return false;
      }))
    return "";
  const SvgFrame frame = frame_of(curves);
  std::string out = svg_opening(frame, axes.title);
  for (const bool strong : {false, true})
    for (const SvgCurve& c : curves)
      if ((c.strong || c.model) == strong) out += drawn(c, frame);
  out += svg_closing(axes.x, axes.y);
  return out + "<figcaption>" + legend_of(curves, axes.most_in_legend) +
         "</figcaption>\n</figure>\n";
}

}  // namespace libchar

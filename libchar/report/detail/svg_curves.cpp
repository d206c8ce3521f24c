#include "libchar/report/detail/svg_curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libchar/core/readable.hpp"
#include "libchar/report/detail/escape.hpp"

namespace libchar {
namespace {

constexpr double kWidth = 760, kHeight = 430, kLeft = 74, kRight = 14, kTop = 12, kBottom = 46;

// Okabe & Ito: told apart by the colour-blind; dashes repeat more slowly than colours.
constexpr std::array<const char*, 7> kColours = {
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#7f7f7f"};
constexpr std::array<const char*, 4> kDashes = {"", "7 3", "2 3", "9 3 2 3"};

struct Axis {
  double low = 0, high = 1;  ///< decimal logarithms
  double from = 0, to = 1;   ///< places in the drawing
  double at(double value) const {
    return from + (to - from) * (std::log10(value) - low) / (high - low);
  }
};

bool drawable(double x, double y) {
  return std::isfinite(x) && std::isfinite(y) && x > 0 && y > 0;
}

void fit_axes(const std::vector<SvgCurve>& curves, Axis& x, Axis& y) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  x.low = y.low = kInfinity;
  x.high = y.high = -kInfinity;
  for (const SvgCurve& c : curves)
    for (std::size_t i = 0; i < c.x.size(); ++i) {
      if (!drawable(c.x[i], c.y[i])) continue;
      x.low = std::min(x.low, std::log10(c.x[i]));
      x.high = std::max(x.high, std::log10(c.x[i]));
      y.low = std::min(y.low, std::log10(c.y[i]));
      y.high = std::max(y.high, std::log10(c.y[i]));
    }
  for (Axis* axis : {&x, &y}) {
    const double margin = std::max(0.08, 0.04 * (axis->high - axis->low));
    axis->low -= margin;
    axis->high += margin;
  }
}

std::string power_text(int exponent) {
  const std::string text = number_text(std::pow(10.0, exponent), 1);
  const std::size_t times = text.find("×");
  return times == std::string::npos ? text : text.substr(times + std::string("×").size());
}

/// Grid lines at 1 … 9 of each decade; labels at decades, and at 2 and 5 where there are few.
std::string grid(const Axis& axis, bool vertical) {
  std::string out;
  const bool few = axis.high - axis.low < 1.6;
  for (int e = static_cast<int>(std::floor(axis.low)); e <= static_cast<int>(std::ceil(axis.high));
       ++e)
    for (int d = 1; d < 10; ++d) {
      const double value = d * std::pow(10.0, e), log = std::log10(value);
      if (log < axis.low || log > axis.high) continue;
      const double at = axis.at(value);
      out += fmt::format(
          "<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>",
          d == 1 ? "decade" : "fine",
          vertical ? at : kLeft,
          vertical ? kTop : at,
          vertical ? at : kWidth - kRight,
          vertical ? kHeight - kBottom : at);
      if (d != 1 && !(few && (d == 2 || d == 5))) continue;
      const std::string text = d == 1 ? power_text(e) : number_text(value, 2);
      out += vertical
                 ? fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>",
                               at,
                               kHeight - kBottom + 16,
                               text)
                 : fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>",
                               kLeft - 6,
                               at + 4,
                               text);
    }
  return out;
}

std::string stroke(const SvgCurve& c) {
  if (c.model) return "stroke=\"currentColor\" stroke-dasharray=\"6 4\" stroke-width=\"2\"";
  const std::string dash = kDashes[c.colour / kColours.size() % kDashes.size()];
  return fmt::format("stroke=\"{}\" stroke-width=\"{}\"{}",
                     kColours[c.colour % kColours.size()],
                     c.strong ? 3.2 : 1.4,
                     dash.empty() ? "" : " stroke-dasharray=\"" + dash + "\"");
}

std::string drawn(const SvgCurve& c, const Axis& x, const Axis& y) {
  std::string points;
  for (std::size_t i = 0; i < c.x.size(); ++i)
    if (drawable(c.x[i], c.y[i]))
      points += fmt::format("{:.1f},{:.1f} ", x.at(c.x[i]), y.at(c.y[i]));
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
  Axis x{0, 1, kLeft, kWidth - kRight}, y{0, 1, kHeight - kBottom, kTop};
  fit_axes(curves, x, y);
  std::string out = fmt::format(
      "<figure class=\"curves\">\n<svg viewBox=\"0 0 {} {}\" role=\"img\" "
      "aria-label=\"{}\">\n{}\n{}\n",
      kWidth,
      kHeight,
      html_attribute(axes.title),
      grid(x, true),
      grid(y, false));
  for (const bool strong : {false, true})
    for (const SvgCurve& c : curves)
      if ((c.strong || c.model) == strong) out += drawn(c, x, y);
  out += fmt::format(
      "<text class=\"axis\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>"
      "<text class=\"axis\" transform=\"translate(16 {}) rotate(-90)\" "
      "text-anchor=\"middle\">{}</text>\n</svg>\n",
      (kLeft + kWidth - kRight) / 2,
      kHeight - 8,
      html_text(axes.x),
      (kTop + kHeight - kBottom) / 2,
      html_text(axes.y));
  return out + "<figcaption>" + legend_of(curves, axes.most_in_legend) +
         "</figcaption>\n</figure>\n";
}

}  // namespace libchar

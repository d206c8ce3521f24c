#include "libchar/report/detail/svg/svg_frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/text/readable.hpp"
#include "libchar/report/detail/escape.hpp"

namespace libchar {
namespace {

constexpr double kWidth = 760, kHeight = 430, kLeft = 74, kRight = 14, kTop = 12, kBottom = 46;

std::string power_text(int exponent) {
  const bool plain = exponent > -4 && exponent < 6;
  return plain ? brief_text(std::pow(10.0, exponent), 1) : power_of_ten(exponent);
}

/// Grid lines at 1 … 9 of each decade; labels at decades, and at 2 and 5 where there are few.
std::string grid(const SvgAxis& axis, bool vertical) {
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

void add_margin(SvgAxis& axis) {
  const double margin = std::max(0.08, 0.04 * (axis.high - axis.low));
  axis.low -= margin;
  axis.high += margin;
}

}  // namespace

double SvgAxis::at(double value) const {
  return from + (to - from) * (std::log10(value) - low) / (high - low);
}

bool drawable(double x, double y) {
  return std::isfinite(x) && std::isfinite(y) && x > 0 && y > 0;
}

SvgFrame svg_frame(double x_low, double x_high, double y_low, double y_high) {
  SvgFrame out{{std::log10(x_low), std::log10(x_high), kLeft, kWidth - kRight},
               {std::log10(y_low), std::log10(y_high), kHeight - kBottom, kTop}};
  add_margin(out.x);
  add_margin(out.y);
  return out;
}

std::string svg_opening(const SvgFrame& frame, const std::string& title) {
  return fmt::format(
      "<figure class=\"curves\">\n<svg viewBox=\"0 0 {} {}\" role=\"img\" "
      "aria-label=\"{}\">\n{}\n{}\n",
      kWidth,
      kHeight,
      html_attribute(title),
      grid(frame.x, true),
      grid(frame.y, false));
}

std::string svg_closing(const std::string& x_title, const std::string& y_title) {
  return fmt::format(
      "<text class=\"axis\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>"
      "<text class=\"axis\" transform=\"translate(16 {}) rotate(-90)\" "
      "text-anchor=\"middle\">{}</text>\n</svg>\n",
      (kLeft + kWidth - kRight) / 2,
      kHeight - 8,
      html_text(x_title),
      (kTop + kHeight - kBottom) / 2,
      html_text(y_title));
}

}  // namespace libchar

#pragma once
// A pair of logarithmic axes as a drawing inside a page: what curves and points of several kinds share.

#include <string>

namespace libchar {

struct SvgAxis {
  double low = 0, high = 1;  ///< decimal logarithms
  double from = 0, to = 1;   ///< places in the drawing
  double at(double value) const;
};

struct SvgFrame {
  SvgAxis x, y;
};

/// Can it stand on such axes?
bool drawable(double x, double y);

/// Axes that hold these values with a margin (all above zero).
SvgFrame svg_frame(double x_low, double x_high, double y_low, double y_high);

/// "<figure>…": the opening, the grid; `title` for readers who cannot see it.
std::string svg_opening(const SvgFrame& frame, const std::string& title);
/// The titles of the axes and the end of the drawing; the figure stays open for a caption.
std::string svg_closing(const std::string& x_title, const std::string& y_title);

}  // namespace libchar

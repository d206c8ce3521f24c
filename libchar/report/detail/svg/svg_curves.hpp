#pragma once
// Many curves on one pair of logarithmic axes, as a drawing inside a page: no script, the same on paper.

#include <string>
#include <vector>

namespace libchar {

struct SvgCurve {
  std::string name;          ///< shown where the pointer rests, and in the legend
  std::size_t colour = 0;    ///< curves of one number look alike
  bool strong = false;       ///< drawn thicker, above the others
  bool model = false;        ///< dashed, in the colour of text
  std::vector<double> x, y;  ///< what is not above zero is left out
};

struct SvgAxes {
  std::string x, y;   ///< titles
  std::string title;  ///< of the figure, for readers who cannot see it
  std::size_t most_in_legend = 12;
};

/// "<figure>…": names are escaped.
std::string svg_curves(const std::vector<SvgCurve>& curves, const SvgAxes& axes);

}  // namespace libchar

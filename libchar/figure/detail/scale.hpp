#pragma once
// An axis on the page: places of values, ticks and their words.

#include <string>
#include <vector>

#include "libchar/figure/figure.hpp"

namespace libchar {

struct PageScale {
  bool log = false;
  double low = 0, high = 1;  ///< of the axis
  double from = 0, to = 1;   ///< their places
  /// Place of a value; NaN for one that has none on a logarithmic axis.
  double at(double value) const;
};

PageScale page_scale(const FigureAxis& axis, double from, double to);

struct Tick {
  double value = 0;
  std::string label;   ///< empty: a line only
  bool strong = true;  ///< a decade, or any of a linear axis
};

/// Round values on the axis: 1 … 9 of each decade where it is logarithmic, with words at decades
/// (every second or third where there are many, at 2 and 5 where there are few), else even steps of
/// 1, 2 or 5. About one word for each `apart` of `length`.
std::vector<Tick> axis_ticks(const FigureAxis& axis, double length, double apart);

}  // namespace libchar

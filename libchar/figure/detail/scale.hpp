#pragma once
// An axis on the page: places of values, ticks and their words.

#include <string>
#include <vector>

#include "libchar/figure/detail/drawing.hpp"
#include "libchar/figure/draw_figure.hpp"
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

// A figure on its way onto the page: the drawing so far, where the frame is, what stands where.

// Sizes of letters, in points: what journals ask for in a figure of final size.
inline constexpr double kTickSize = 7, kAxisSize = 8, kLegendSize = 7, kTitleSize = 9;

struct Sheet {
  const Chart* figure = nullptr;
  bool grey = false;
  Drawing drawing;
  PageScale x, y;
  std::vector<Place> busy;  ///< points of curves: texts stay off them
  std::vector<Box> taken;   ///< texts and marks: nothing else stands there
};

Colour colour_of(Ink ink, bool grey);
/// The colour of a band or a stretch on white.
Colour pale(Colour colour, double share);
std::vector<double> dash_of(std::size_t number);

/// A marker at a place; hollow ones are white inside.
void add_marker(Sheet& sheet, const FigureLook& look, const std::vector<Place>& at, bool hollow,
                const std::string& tip = "");

/// Stretches and bands; lines and markers of series; bars; whiskers. Fills `busy`.
void draw_backgrounds(Sheet& sheet);
void draw_series(Sheet& sheet);
void draw_bars(Sheet& sheet);

/// A name in the legend with what stands for it.
struct LegendEntry {
  enum class Kind { line, area, bar };
  Kind kind = Kind::line;
  std::string name;
  FigureLook look;
  bool hollow = false;
  double opacity = 1;
};
std::vector<LegendEntry> legend_entries(const Chart& figure);
inline constexpr double kLegendSwatch = 30;  ///< room for what stands beside a name
/// Height of the legend in rows of at most `width`.
double legend_height(const std::vector<LegendEntry>& entries, double width);
void draw_legend_below(Sheet& sheet, const std::vector<LegendEntry>& entries, const Box& room);
/// In the corner of the frame where no curve is; false where there is none and `anyway` is not set.
bool draw_legend_inside(Sheet& sheet, const std::vector<LegendEntry>& entries, bool anyway);

/// Marks with their words, each where it hides least.
void draw_marks(Sheet& sheet);

/// The whole figure. Throws Error(usage) where the size leaves no room for a plot.
Drawing lay_out(const Chart& figure, const DrawingOptions& options);

inline constexpr double kBandOpacity = 0.2, kStretchOpacity = 0.12;

}  // namespace libchar

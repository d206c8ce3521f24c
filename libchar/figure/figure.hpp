#pragma once
// A figure before it is drawn: axes, series, marks, in the units of the data. SVG, PDF, PNG,
// gnuplot, CSV and the terminal are all made of it.

#include <cstddef>
#include <string>
#include <vector>

namespace libchar {

/// Colours by name: those of Okabe and Ito, which the colour-blind tell apart, then text and its fainter kind.
enum class Ink { blue, vermilion, green, purple, orange, sky, black, grey };
/// Colours of series, before they repeat with other dashes.
inline constexpr std::size_t kSeriesInks = 7;

enum class FigureMarker { none, circle, square, triangle, diamond, down, cross };

/// Distinguished by dash and marker as well as by colour, for print in grey.
struct FigureLook {
  Ink ink = Ink::blue;
  std::size_t dash = 0;  ///< number of a pattern; 0: a whole line
  double width = 1.1;    ///< of the line in points; 0: none
  FigureMarker marker = FigureMarker::none;
  double size = 1.5;  ///< radius of a marker in points
};

struct FigureSeries {
  std::string name;               ///< in the legend; empty: not there
  std::vector<double> x, y;       ///< NaN interrupts the line
  std::vector<double> low, high;  ///< a band around it, as many; empty: none
  std::string band;               ///< of the band in the legend; empty: not there
  FigureLook look;
  std::vector<bool> hollow;  ///< markers that are drawn so, as many; empty: none
  bool behind = false;       ///< drawn before the others, in any place of the legend
  std::string tip = {};      ///< where the pointer rests, on a page
};

/// A point with a word next to it.
struct FigureMark {
  double x = 0, y = 0;
  std::string text;
  FigureLook look;
  bool hollow = false;
  std::string tip = {};  ///< where the pointer rests, on a page
};

/// A line from one point to another, such as an interval next to a mark.
struct FigureWhisker {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  Ink ink = Ink::black;
};

/// A stretch of the horizontal axis that is shaded from bottom to top.
struct FigureStretch {
  double from = 0, to = 0;
  std::string name;  ///< in the legend; empty: not there
  Ink ink = Ink::grey;
};

/// A stretch of one row of the vertical axis.
struct FigureBar {
  std::size_t row = 0;
  double from = 0, to = 0;
  std::string name;  ///< in the legend; the same for bars of one look
  std::string note;  ///< next to it, if there is room
  Ink ink = Ink::grey;
  bool broad = false, hollow = false;
};

struct FigureAxis {
  std::string title;  ///< with the unit
  bool log = false;
  double low = 0, high = 1;       ///< ends
  std::vector<std::string> rows;  ///< of the vertical axis: names at 0, 1, 2… from the top
};

struct Chart {
  std::string kind;   ///< the word it was asked for by
  std::string title;  ///< above it; empty: none
  std::string about;  ///< for readers who cannot see it, and what a PDF says as its title
  std::string note;   ///< small, in a corner: what could not be drawn where it is
  FigureAxis x, y;
  std::vector<FigureStretch> stretches;
  std::vector<FigureSeries> series;
  std::vector<FigureBar> bars;
  std::vector<FigureWhisker> whiskers;
  std::vector<FigureMark> marks;
};

}  // namespace libchar

#pragma once
// A figure as a file: SVG is written here, PDF and PNG are drawn by Cairo, all three from one list of lines and texts.

#include <cstddef>
#include <string>

#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/figure/figure.hpp"

namespace libchar {

enum class LegendPlace {
  automatic,  ///< in a corner where no curve is, else below
  inside,
  below,
  none,
};
template <>
inline constexpr auto enum_table<LegendPlace> = enum_words<LegendPlace, "auto inside below none">;

enum class FigureFormat { svg, pdf, png };
template <>
inline constexpr auto enum_table<FigureFormat> = enum_words<FigureFormat, "svg pdf png">;

inline constexpr double kOneColumnMm = 85, kTwoColumnsMm = 178;

struct DrawingOptions {
  double width_mm = kOneColumnMm;
  double height_mm = 0;  ///< 0: what suits the width
  double shape = 0;      ///< then height of the frame over the width; 0: what suits it
  LegendPlace legend = LegendPlace::automatic;
  bool grey = false;  ///< no colour at all
  double dpi = 300;   ///< of PNG
};

/// Whether PDF and PNG can be drawn: the library was built with Cairo.
bool draws_with_cairo();

/// The bytes of the file: the same for the same figure and options. Text is text, in Liberation
/// Sans, which has the widths of Arial and Helvetica; a PDF embeds what it uses of it. Where the
/// font is not installed, PDF and PNG take another one and `warnings` says so (SVG names both).
/// Throws Error(usage) for a PDF or PNG without Cairo and for sizes that nothing can be drawn in.
std::string draw_figure(const Chart& figure, FigureFormat format, const DrawingOptions& options, Findings& warnings);

/// As part of a page, on which no other figure says the same of itself: without a size of its own;
/// where the pointer rests, it says what a curve or a mark is.
std::string draw_figure(const Chart& figure, const DrawingOptions& options);

// A figure in a terminal: braille dots, two by four in a character.

struct TerminalFigureOptions {
  std::size_t columns = 80;  ///< of the terminal
  std::size_t rows = 20;     ///< of the plot, without axis and legend
  bool colour = false;       ///< escapes of ECMA-48
};

/// Lines that end in a newline, none wider than `columns` (at least 40). Each series has a letter
/// where there are several, and a colour.
std::string terminal_figure(const Chart& figure, const TerminalFigureOptions& options);

// The numbers of a figure, for those who draw it themselves.

/// part,name,x,y,low,high,text: one row per point. Parts: series, mark, interval (of a mark: from x,y
/// to low,high), stretch, bar (its row in y).
std::string figure_csv(const Chart& figure);

/// A script for gnuplot 5 that holds the numbers and draws the figure: gnuplot -e "set terminal
/// pdfcairo; set output 'f.pdf'" FILE.
std::string figure_gnuplot(const Chart& figure, const DrawingOptions& options);

}  // namespace libchar

#pragma once
// The numbers of a figure, for those who draw it themselves.

#include <string>

#include "libchar/figure/draw_figure.hpp"
#include "libchar/figure/figure.hpp"

namespace libchar {

/// part,name,x,y,low,high,text: one row per point. Parts: series, mark, interval (of a mark: from x,y
/// to low,high), stretch, bar (its row in y).
std::string figure_csv(const Chart& figure);

/// A script for gnuplot 5 that holds the numbers and draws the figure: gnuplot -e "set terminal
/// pdfcairo; set output 'f.pdf'" FILE.
std::string figure_gnuplot(const Chart& figure, const DrawingOptions& options);

}  // namespace libchar

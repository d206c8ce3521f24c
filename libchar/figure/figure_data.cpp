#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/markup.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/figure/detail/scale.hpp"
#include "libchar/figure/draw_figure.hpp"

namespace libchar {
namespace {

std::string csv_row(const char* part, const std::string& name, std::initializer_list<double> numbers,
                    const std::string& text = "") {
  std::string out = fmt::format("{},{}", part, csv_cell(name));
  for (const double v : numbers) out += "," + csv_cell(v);
  return out + "," + csv_cell(text) + "\n";
}

double at_or_none(const std::vector<double>& values, std::size_t i) { return i < values.size() ? values[i] : kNone; }

// gnuplot reads backslashes and quotes in double quotes; single ones are doubled. Its enhanced text is switched off.
std::string gnuplot_text(const std::string& text) {
  std::string out = "'";
  for (const char c : printable(text)) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

std::string gnuplot_colour(Ink ink, bool grey) {
  const Colour c = colour_of(ink, grey);
  const auto part = [](double v) { return clamped_whole<int>(std::round(255 * v)); };
  return fmt::format("rgb '#{:02x}{:02x}{:02x}'", part(c.red), part(c.green), part(c.blue));
}

std::string gnuplot_number(double value) { return std::isfinite(value) ? shortest(value) : "NaN"; }

std::string gnuplot_dash(std::size_t number) {
  std::string out;
  for (const double d : dash_of(number)) out += (out.empty() ? "" : ",") + shortest(4 * d);
  return out.empty() ? "dt solid" : fmt::format("dt ({})", out);
}

int point_type(FigureMarker marker, bool hollow) {
  switch (marker) {
    case FigureMarker::circle:
      return hollow ? 6 : 7;
    case FigureMarker::square:
      return hollow ? 4 : 5;
    case FigureMarker::triangle:
      return hollow ? 8 : 9;
    case FigureMarker::down:
      return hollow ? 10 : 11;
    case FigureMarker::diamond:
      return hollow ? 12 : 13;
    default:
      return 2;
  }
}

std::string gnuplot_axis(const char* name, const FigureAxis& axis, bool reversed) {
  std::string out = fmt::format("set {}label {}\n", name, gnuplot_text(axis.title));
  if (axis.log) out += fmt::format("set logscale {}\nset format {} '%g'\n", name, name);
  out += fmt::format("set {}range [{}:{}]\n", name, gnuplot_number(reversed ? axis.high : axis.low),
                     gnuplot_number(reversed ? axis.low : axis.high));
  if (axis.rows.empty()) return out;
  std::string rows;
  for (std::size_t k = 0; k < axis.rows.size(); ++k)
    rows += fmt::format("{}{} {}", k == 0 ? "" : ", ", gnuplot_text(axis.rows[k]), k);
  return out + fmt::format("set {}tics ({})\n", name, rows);
}

std::string data_block(std::size_t k, const FigureSeries& s) {
  std::string out = fmt::format("$series{} << EOD\n", k);
  for (std::size_t i = 0; i < s.x.size(); ++i)
    out += fmt::format("{} {} {} {}\n", gnuplot_number(s.x[i]), gnuplot_number(at_or_none(s.y, i)),
                       gnuplot_number(at_or_none(s.low, i)), gnuplot_number(at_or_none(s.high, i)));
  return out + "EOD\n";
}

std::string objects_of(const Chart& figure, bool grey) {
  std::string out;
  for (const FigureStretch& s : figure.stretches)
    out += fmt::format(
        "set object rectangle from {}, graph 0 to {}, graph 1 behind fillcolor {} fillstyle solid {} noborder\n",
        gnuplot_number(std::max(s.from, figure.x.low)), gnuplot_number(std::min(s.to, figure.x.high)),
        gnuplot_colour(s.ink, grey), kStretchOpacity);
  for (const FigureBar& b : figure.bars) {
    const double half = b.broad ? 0.44 : 0.13;
    out += fmt::format("set object rectangle from {}, {} to {}, {} fillcolor {} fillstyle {}\n", gnuplot_number(b.from),
                       gnuplot_number(static_cast<double>(b.row) - half), gnuplot_number(b.to),
                       gnuplot_number(static_cast<double>(b.row) + half), gnuplot_colour(b.ink, grey),
                       b.broad    ? "solid 0.45 noborder"
                       : b.hollow ? "empty border"
                                  : "solid 1 noborder");
  }
  for (const FigureWhisker& w : figure.whiskers)
    out += fmt::format("set arrow from {}, {} to {}, {} nohead linecolor {}\n", gnuplot_number(w.x0),
                       gnuplot_number(w.y0), gnuplot_number(w.x1), gnuplot_number(w.y1), gnuplot_colour(w.ink, grey));
  for (const FigureMark& m : figure.marks)
    out += fmt::format("set label {} at {}, {} offset 1, 0.5 point pt {} ps {} lc {}\n", gnuplot_text(m.text),
                       gnuplot_number(m.x), gnuplot_number(m.y), point_type(m.look.marker, m.hollow),
                       shortest(std::round(10 * m.look.size / 3) / 10), gnuplot_colour(m.look.ink, grey));
  return out;
}

std::vector<std::string> plots_of(const Chart& figure, bool grey) {
  std::vector<std::string> out;
  for (std::size_t k = 0; k < figure.series.size(); ++k) {
    const FigureSeries& s = figure.series[k];
    if (s.low.empty() || s.x.size() < 2) continue;
    out.push_back(fmt::format(
        "$series{} using 1:3:4 with filledcurves fillcolor {} fillstyle transparent solid {} noborder {}", k,
        gnuplot_colour(s.look.ink, grey), kBandOpacity, s.band.empty() ? "notitle" : "title " + gnuplot_text(s.band)));
  }
  for (std::size_t k = 0; k < figure.series.size(); ++k) {
    const FigureSeries& s = figure.series[k];
    if (s.x.empty()) continue;
    const bool line = s.look.width > 0, marker = s.look.marker != FigureMarker::none;
    std::string how = line && marker ? "linespoints" : line ? "lines" : "points";
    how += " lc " + gnuplot_colour(s.look.ink, grey);
    if (line) how += fmt::format(" lw {} {}", shortest(s.look.width), gnuplot_dash(s.look.dash));
    if (marker)
      how += fmt::format(" pt {} ps {}", point_type(s.look.marker, false),
                         shortest(std::round(10 * s.look.size / 3) / 10));
    out.push_back(fmt::format("$series{} using 1:2 with {} {}", k, how,
                              s.name.empty() ? "notitle" : "title " + gnuplot_text(s.name)));
  }
  return out;
}

}  // namespace

std::string figure_csv(const Chart& figure) {
  std::string out = "part,name,x,y,low,high,text\n";
  for (const FigureSeries& s : figure.series)
    for (std::size_t i = 0; i < s.x.size(); ++i)
      out += csv_row("series", s.name, {s.x[i], at_or_none(s.y, i), at_or_none(s.low, i), at_or_none(s.high, i)});
  for (const FigureMark& m : figure.marks) out += csv_row("mark", "", {m.x, m.y, kNone, kNone}, m.text);
  for (const FigureWhisker& w : figure.whiskers) out += csv_row("interval", "", {w.x0, w.y0, w.x1, w.y1});
  for (const FigureStretch& s : figure.stretches) out += csv_row("stretch", s.name, {s.from, kNone, s.from, s.to});
  for (const FigureBar& b : figure.bars)
    out += csv_row("bar", b.name, {b.from, static_cast<double>(b.row), b.from, b.to}, b.note);
  return out;
}

std::string figure_gnuplot(const Chart& figure, const DrawingOptions& options) {
  std::string out =
      "# A figure of sensorchar, for gnuplot 5. To a file:\n"
      "#   gnuplot -e \"set terminal pdfcairo; set output 'figure.pdf'\" THIS_FILE\n"
      "set encoding utf8\nset termoption noenhanced\nset clip two\n";
  for (std::size_t k = 0; k < figure.series.size(); ++k)
    if (!figure.series[k].x.empty()) out += data_block(k, figure.series[k]);
  if (!figure.title.empty()) out += "set title " + gnuplot_text(figure.title) + "\n";
  out += gnuplot_axis("x", figure.x, false) + gnuplot_axis("y", figure.y, !figure.y.rows.empty());
  out += "set grid\n";
  out += options.legend == LegendPlace::none     ? "unset key\n"
         : options.legend == LegendPlace::inside ? "set key top right\n"
                                                 : "set key below\n";
  out += objects_of(figure, options.grey);
  const std::vector<std::string> plots = plots_of(figure, options.grey);
  out += "plot ";
  for (std::size_t k = 0; k < plots.size(); ++k) out += (k == 0 ? "" : ", \\\n     ") + plots[k];
  // Marks and bars alone: a plot of nothing shows them.
  return out + (plots.empty() ? "NaN notitle\n" : "\n");
}

}  // namespace libchar

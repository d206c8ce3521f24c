// Braille patterns of Unicode: a character has two columns of four dots, each a bit.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/figure/detail/scale.hpp"
#include "libchar/figure/draw_figure.hpp"

namespace libchar {
namespace {

constexpr std::size_t kLeastColumns = 40, kLeastRows = 4, kMostRows = 200, kMostColumns = 1000;
// Colours of ECMA-48 that are told apart on light and dark screens: blue, red, green, magenta, yellow, cyan.
constexpr std::array<int, 6> kTerminalInks = {34, 31, 32, 35, 33, 36};

std::string utf8(char32_t c) {
  return {static_cast<char>(0xE0U | (c >> 12U)), static_cast<char>(0x80U | ((c >> 6U) & 0x3FU)),
          static_cast<char>(0x80U | (c & 0x3FU))};
}

struct Cell {
  unsigned dots = 0;
  int series = -1;  ///< who drew last
  char letter = 0;  ///< in place of dots
  bool grid = false;
};

class BrailleCanvas {
 public:
  BrailleCanvas(std::size_t columns, std::size_t rows) : columns_(columns), rows_(rows), cells_(columns * rows) {}

  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return rows_; }
  double width() const { return 2 * static_cast<double>(columns_) - 1; }
  double height() const { return 4 * static_cast<double>(rows_) - 1; }

  void dot(double x, double y, int series) {
    const auto column = clamped_whole<std::int64_t>(std::round(x)), row = clamped_whole<std::int64_t>(std::round(y));
    if (column < 0 || row < 0 || std::cmp_greater_equal(column, 2 * columns_) || std::cmp_greater_equal(row, 4 * rows_))
      return;
    Cell& c = cell(static_cast<std::size_t>(column) / 2, static_cast<std::size_t>(row) / 4);
    constexpr unsigned kBits[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
    c.dots |= kBits[row % 4][column % 2];
    c.series = series;
  }

  void line(double x0, double y0, double x1, double y1, int series) {
    const double longest = std::max(std::fabs(x1 - x0), std::fabs(y1 - y0));
    // What leads far out of the picture is cut by the number of its steps.
    const int steps = std::max(1, static_cast<int>(std::min(longest, 4.0 * (width() + height()))));
    for (int k = 0; k <= steps; ++k) dot(x0 + (x1 - x0) * k / steps, y0 + (y1 - y0) * k / steps, series);
  }

  void letter(double x, double y, char c, int series) {
    const auto column = clamped_whole<std::int64_t>(std::round(x)) / 2,
               row = clamped_whole<std::int64_t>(std::round(y)) / 4;
    if (column < 0 || row < 0 || column >= static_cast<long long>(columns_) || row >= static_cast<long long>(rows_))
      return;
    Cell& at = cell(static_cast<std::size_t>(column), static_cast<std::size_t>(row));
    if (at.letter != 0) return;
    at.letter = c;
    at.series = series;
  }

  Cell& cell(std::size_t column, std::size_t row) { return cells_[row * columns_ + column]; }

 private:
  std::size_t columns_, rows_;
  std::vector<Cell> cells_;
};

struct TerminalScales {
  PageScale x, y;
};

void draw_terminal_series(BrailleCanvas& canvas, const TerminalScales& scales, const FigureSeries& s, int number) {
  double x0 = NAN, y0 = NAN;
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    const double x = scales.x.at(s.x[i]), y = scales.y.at(s.y[i]);
    if (std::isfinite(x) && std::isfinite(y)) {
      if (std::isfinite(x0))
        canvas.line(x0, y0, x, y, number);
      else
        canvas.dot(x, y, number);
    }
    x0 = x;
    y0 = y;
  }
}

/// At a few places along the curve, each series at others, so that two that lie together still show both.
void letter_terminal_series(BrailleCanvas& canvas, const TerminalScales& scales, const FigureSeries& s, int number) {
  constexpr double kApart = 24;
  const char letter = static_cast<char>('a' + number % 26);
  double next = 2.0 + 6.0 * (number % 4);
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    const double x = scales.x.at(s.x[i]), y = scales.y.at(s.y[i]);
    if (!std::isfinite(x) || !std::isfinite(y) || x < next) continue;
    canvas.letter(x, y, letter, number);
    next = x + kApart;
  }
}

std::string coloured(const std::string& text, int series, bool colour) {
  if (!colour || series < 0) return text;
  return fmt::format("\x1b[{}m{}\x1b[0m", kTerminalInks[static_cast<std::size_t>(series) % kTerminalInks.size()], text);
}

std::string canvas_row(BrailleCanvas& canvas, std::size_t row, bool colour) {
  std::string out;
  std::size_t blanks = 0;
  for (std::size_t column = 0; column < canvas.columns(); ++column) {
    const Cell& c = canvas.cell(column, row);
    if (c.dots == 0 && c.letter == 0) {
      if (c.grid) {
        out += std::string(blanks, ' ') + "·";
        blanks = 0;
      } else {
        ++blanks;
      }
      continue;
    }
    out += std::string(blanks, ' ');
    blanks = 0;
    out += coloured(c.letter != 0 ? std::string(1, c.letter) : utf8(0x2800U + c.dots), c.series, colour);
  }
  return out;
}

/// Words in one line, each around its place, those that do not fit left out.
std::string word_line(const std::vector<std::pair<double, std::string>>& words, std::size_t columns) {
  std::string out;
  std::size_t used = 0;
  for (const auto& [at, word] : words) {
    const std::size_t width = width_of(word);
    double left = std::floor(at - static_cast<double>(width) / 2 + 0.5);
    left = std::min(left, static_cast<double>(columns) - static_cast<double>(width));
    if (left < 0 || (used > 0 && left < static_cast<double>(used + 1))) continue;
    const auto from = static_cast<std::size_t>(left);
    out += std::string(from - used, ' ') + word;
    used = from + width;
  }
  return out;
}

struct TerminalAxes {
  std::vector<Tick> x, y;
  std::size_t left = 0;  ///< columns in front of the plot
};

TerminalAxes terminal_axes(const Chart& figure, std::size_t columns, std::size_t rows) {
  TerminalAxes out;
  out.y = axis_ticks(figure.y, static_cast<double>(rows), figure.y.log ? 2.5 : 3);
  for (const Tick& t : out.y) out.left = std::max(out.left, width_of(t.label));
  out.left = std::min(out.left, columns / 3) + 1;
  out.x = axis_ticks(figure.x, static_cast<double>(columns - out.left - 1), figure.x.log ? 7 : 10);
  return out;
}

std::string legend_lines(const Chart& figure, const TerminalFigureOptions& options, std::size_t columns) {
  std::string out, line;
  for (std::size_t k = 0; k < figure.series.size(); ++k) {
    if (figure.series[k].name.empty()) continue;
    const std::string words =
        fmt::format("{} {}", static_cast<char>('a' + k % 26), printable(figure.series[k].name, columns - 4));
    if (!line.empty() && width_of(line) + 3 + width_of(words) > columns) {
      out += line + "\n";
      line.clear();
    }
    line += (line.empty() ? " " : "   ") + words;
  }
  // Colours count no columns: they are put in when the lines are known.
  if (!line.empty()) out += line + "\n";
  if (!options.colour) return out;
  for (std::size_t k = 0; k < figure.series.size(); ++k) {
    const std::string key =
        fmt::format(" {} {}", static_cast<char>('a' + k % 26), printable(figure.series[k].name, columns - 4));
    const std::size_t at = out.find(key);
    if (at != std::string::npos) out.replace(at, key.size(), " " + coloured(key.substr(1), static_cast<int>(k), true));
  }
  return out;
}

void mark_decades(BrailleCanvas& canvas, const TerminalAxes& axes, const TerminalScales& scales) {
  for (const Tick& x : axes.x)
    for (const Tick& y : axes.y) {
      if (!x.strong || !y.strong) continue;
      const auto column = clamped_whole<std::size_t>(std::round(scales.x.at(x.value))) / 2,
                 row = clamped_whole<std::size_t>(std::round(scales.y.at(y.value))) / 4;
      if (column < canvas.columns() && row < canvas.rows()) canvas.cell(column, row).grid = true;
    }
}

}  // namespace

std::string terminal_figure(const Chart& figure, const TerminalFigureOptions& options) {
  const std::size_t columns = std::clamp(options.columns, kLeastColumns, kMostColumns),
                    rows = std::clamp(options.rows, kLeastRows, kMostRows);
  const TerminalAxes axes = terminal_axes(figure, columns, rows);
  BrailleCanvas canvas(columns - axes.left - 1, rows);
  const TerminalScales scales{page_scale(figure.x, 0, canvas.width()), page_scale(figure.y, canvas.height(), 0)};
  mark_decades(canvas, axes, scales);
  const bool many = figure.series.size() > 1;
  for (std::size_t k = 0; k < figure.series.size(); ++k)
    draw_terminal_series(canvas, scales, figure.series[k], static_cast<int>(k));
  for (std::size_t k = 0; many && k < figure.series.size(); ++k)
    letter_terminal_series(canvas, scales, figure.series[k], static_cast<int>(k));
  std::string out = printable(figure.y.title, columns - 1) + "\n";
  for (std::size_t row = 0; row < rows; ++row) {
    std::string label;
    for (const Tick& t : axes.y)
      if (!t.label.empty() && clamped_whole<std::size_t>(std::round(scales.y.at(t.value))) / 4 == row) label = t.label;
    const std::size_t width = width_of(label);
    out += std::string(axes.left - 1 - std::min(width, axes.left - 1), ' ') + label + (label.empty() ? " │" : " ┤") +
           canvas_row(canvas, row, options.colour) + "\n";
  }
  out += std::string(axes.left, ' ') + "└";
  for (std::size_t c = 0; c < canvas.columns(); ++c) {
    const bool tick = std::any_of(axes.x.begin(), axes.x.end(), [&](const Tick& t) {
      return !t.label.empty() && clamped_whole<std::size_t>(std::round(scales.x.at(t.value))) / 2 == c;
    });
    out += tick ? "┬" : "─";
  }
  std::vector<std::pair<double, std::string>> words;
  for (const Tick& t : axes.x)
    if (!t.label.empty()) words.emplace_back(static_cast<double>(axes.left + 1) + scales.x.at(t.value) / 2, t.label);
  out += "\n" + word_line(words, columns) + "\n";
  out += word_line({{static_cast<double>(columns + axes.left) / 2, printable(figure.x.title, columns - 2)}}, columns) +
         "\n";
  return out + (many ? legend_lines(figure, options, columns) : "");
}

}  // namespace libchar

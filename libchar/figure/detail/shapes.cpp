// Series, bands, bars and stretches as paths.

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/figure/detail/scale.hpp"

namespace libchar {
namespace {

// Of the page: finer than this nobody sees.
constexpr double kColumn = 0.25;
// Beyond the frame, where lines are cut off.
constexpr double kBeyond = 6;

bool is_place(const Place& p) { return std::isfinite(p.x) && std::isfinite(p.y); }

Place place_of(const Sheet& sheet, double x, double y) { return {sheet.x.at(x), sheet.y.at(y)}; }

/// A place inside the frame by the finest step that is seen.
long cell_of(double coordinate) { return clamped_whole<long>(std::round(coordinate / kColumn)); }

/// Runs of points without gaps; of a column that many points share the first, lowest, highest and last.
std::vector<std::vector<Place>> runs_of(const Sheet& sheet, const FigureSeries& s) {
  std::vector<std::vector<Place>> out;
  std::vector<Place> column;
  const auto close_column = [&] {
    if (column.empty()) return;
    std::vector<Place>& run = out.back();
    if (column.size() > 4) {
      const auto by_y = [](const Place& a, const Place& b) { return a.y < b.y; };
      auto low = std::min_element(column.begin(), column.end(), by_y),
           high = std::max_element(column.begin(), column.end(), by_y);
      if (high < low) std::swap(low, high);
      column = {column.front(), *low, *high, column.back()};
    }
    run.insert(run.end(), column.begin(), column.end());
    column.clear();
  };
  bool open = false;
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    const Place p = place_of(sheet, s.x[i], s.y[i]);
    if (!is_place(p)) {
      close_column();
      open = false;
      continue;
    }
    if (!open) {
      out.emplace_back();
      open = true;
    }
    if (!column.empty() && std::floor(p.x / kColumn) != std::floor(column[0].x / kColumn)) close_column();
    column.push_back(p);
  }
  close_column();
  return out;
}

/// The part of a line inside the box (Liang and Barsky, ACM Transactions on Graphics 3, 1984).
bool cut_to(const Box& box, Place& a, Place& b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  double from = 0, to = 1;
  const auto side = [&](double p, double q) {
    if (p == 0) return q >= 0;
    const double r = q / p;
    if (p < 0) from = std::max(from, r);
    if (p > 0) to = std::min(to, r);
    return from <= to;
  };
  if (!side(-dx, a.x - box.left) || !side(dx, box.right - a.x) || !side(-dy, a.y - box.top) ||
      !side(dy, box.bottom - a.y))
    return false;
  const Place start = a;
  a = {start.x + from * dx, start.y + from * dy};
  b = {start.x + to * dx, start.y + to * dy};
  return true;
}

Box grown(const Box& box, double by) { return {box.left - by, box.top - by, box.right + by, box.bottom + by}; }

std::vector<std::vector<Place>> cut(const std::vector<std::vector<Place>>& runs, const Box& box) {
  std::vector<std::vector<Place>> out;
  for (const std::vector<Place>& run : runs) {
    bool joined = false;
    for (std::size_t i = 1; i < run.size(); ++i) {
      Place a = run[i - 1], b = run[i];
      if (!cut_to(box, a, b)) {
        joined = false;
        continue;
      }
      if (!joined) out.push_back({a});
      out.back().push_back(b);
      joined = b.x == run[i].x && b.y == run[i].y;
    }
  }
  return out;
}

/// Points along lines, close enough that no letter slips between them.
void take_busy(Sheet& sheet, const std::vector<std::vector<Place>>& lines) {
  constexpr double kStep = 2;
  for (const std::vector<Place>& line : lines)
    for (std::size_t i = 1; i < line.size(); ++i) {
      const Place a = line[i - 1], b = line[i];
      const double length = std::hypot(b.x - a.x, b.y - a.y);
      const int steps = std::max(1, static_cast<int>(length / kStep));
      for (int k = 0; k <= steps; ++k)
        sheet.busy.push_back({a.x + (b.x - a.x) * k / steps, a.y + (b.y - a.y) * k / steps});
    }
}

void draw_band(Sheet& sheet, const FigureSeries& s) {
  const Box& frame = sheet.drawing.frame;
  std::vector<std::vector<Place>> lows, highs;
  bool open = false;
  for (std::size_t i = 0; i < s.x.size() && i < s.low.size() && i < s.high.size(); ++i) {
    // An interval that reaches zero goes down to the frame.
    const double low = sheet.y.log && s.low[i] <= 0 ? sheet.y.low : s.low[i];
    Place a = place_of(sheet, s.x[i], low), b = place_of(sheet, s.x[i], s.high[i]);
    if (!is_place(a) || !is_place(b)) {
      open = false;
      continue;
    }
    for (Place* p : {&a, &b}) p->y = std::clamp(p->y, frame.top - kBeyond, frame.bottom + kBeyond);
    if (!open) {
      lows.emplace_back();
      highs.emplace_back();
      open = true;
    }
    if (!lows.back().empty() && std::floor(a.x / kColumn) == std::floor(lows.back().back().x / kColumn)) {
      lows.back().back().y = std::max(lows.back().back().y, a.y);
      highs.back().back().y = std::min(highs.back().back().y, b.y);
      continue;
    }
    lows.back().push_back(a);
    highs.back().push_back(b);
  }
  DrawnPath path;
  path.filled = true;
  path.stroked = false;
  path.fill = colour_of(s.look.ink, sheet.grey);
  path.opacity = kBandOpacity;
  path.clipped = true;
  for (std::size_t k = 0; k < lows.size(); ++k) {
    if (lows[k].size() < 2) continue;
    std::vector<Place> around = highs[k];
    around.insert(around.end(), lows[k].rbegin(), lows[k].rend());
    path.lines.push_back(std::move(around));
  }
  if (path.lines.empty()) return;
  take_busy(sheet, lows);
  take_busy(sheet, highs);
  sheet.drawing.add(std::move(path));
}

void draw_line(Sheet& sheet, const FigureSeries& s) {
  const auto lines = cut(runs_of(sheet, s), grown(sheet.drawing.frame, kBeyond));
  take_busy(sheet, lines);
  if (lines.empty() || !(s.look.width > 0)) return;
  DrawnPath path;
  path.lines = lines;
  path.stroke = colour_of(s.look.ink, sheet.grey);
  path.width = s.look.width;
  path.dash = dash_of(s.look.dash);
  path.clipped = true;
  path.tip = s.tip;
  sheet.drawing.add(std::move(path));
}

void draw_markers(Sheet& sheet, const FigureSeries& s) {
  if (s.look.marker == FigureMarker::none) return;
  // Beside a line, markers of a dense curve would hide it: those that are not too close are enough.
  const double apart = s.look.width > 0 ? 9 : 0;
  // Without a line, those at one place are one.
  std::set<std::pair<long, long>> taken;
  std::vector<Place> full, hollow;
  double last = -INFINITY;
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    const Place p = place_of(sheet, s.x[i], s.y[i]);
    if (!is_place(p) || !sheet.drawing.frame.holds(p) || p.x - last < apart) continue;
    const bool is_hollow = i < s.hollow.size() && s.hollow[i];
    if (apart == 0 && !taken.emplace(cell_of(p.x), 2 * cell_of(p.y) + is_hollow).second) continue;
    last = p.x;
    (is_hollow ? hollow : full).push_back(p);
    sheet.busy.push_back(p);
  }
  add_marker(sheet, s.look, full, false);
  add_marker(sheet, s.look, hollow, true);
}

std::vector<Place> outline(FigureMarker marker, const Place& c, double r) {
  switch (marker) {
    case FigureMarker::square: {
      const double a = 0.9 * r;
      return {{c.x - a, c.y - a}, {c.x + a, c.y - a}, {c.x + a, c.y + a}, {c.x - a, c.y + a}};
    }
    case FigureMarker::triangle:
      return {{c.x, c.y - 1.15 * r}, {c.x + 1.1 * r, c.y + 0.8 * r}, {c.x - 1.1 * r, c.y + 0.8 * r}};
    case FigureMarker::down:
      return {{c.x, c.y + 1.15 * r}, {c.x + 1.1 * r, c.y - 0.8 * r}, {c.x - 1.1 * r, c.y - 0.8 * r}};
    case FigureMarker::diamond:
      return {{c.x, c.y - 1.2 * r}, {c.x + 1.2 * r, c.y}, {c.x, c.y + 1.2 * r}, {c.x - 1.2 * r, c.y}};
    default:
      return {};
  }
}

}  // namespace

void add_marker(Sheet& sheet, const FigureLook& look, const std::vector<Place>& at, bool hollow,
                const std::string& tip) {
  if (at.empty() || look.marker == FigureMarker::none) return;
  DrawnPath path;
  path.tip = tip;
  path.stroke = colour_of(look.ink, sheet.grey);
  path.fill = hollow ? Colour{1, 1, 1} : path.stroke;
  path.filled = true;
  path.width = hollow ? std::max(0.6, look.width) : 0.4;
  if (look.marker == FigureMarker::circle) {
    path.circles = at;
    path.radius = look.size;
  } else if (look.marker == FigureMarker::cross) {
    path.filled = false;
    path.width = 0.8;
    for (const Place& c : at) {
      const double r = look.size;
      path.lines.push_back({{c.x - r, c.y - r}, {c.x + r, c.y + r}});
      path.lines.push_back({{c.x - r, c.y + r}, {c.x + r, c.y - r}});
    }
  } else {
    for (const Place& c : at) path.lines.push_back(outline(look.marker, c, look.size));
  }
  sheet.drawing.add(std::move(path));
}

void draw_backgrounds(Sheet& sheet) {
  const Box& frame = sheet.drawing.frame;
  for (const FigureStretch& s : sheet.figure->stretches) {
    const double from = s.from > sheet.x.low ? sheet.x.at(s.from) : frame.left;
    const double to = s.to < sheet.x.high ? sheet.x.at(s.to) : frame.right;
    if (!(from < frame.right) || !(to > frame.left)) continue;
    DrawnPath path;
    path.filled = true;
    // An instant is a line.
    path.stroked = to - from < 0.5;
    path.stroke = colour_of(s.ink, sheet.grey);
    path.fill = path.stroke;
    path.opacity = kStretchOpacity;
    path.clipped = true;
    path.lines = {{{from, frame.top}, {to, frame.top}, {to, frame.bottom}, {from, frame.bottom}}};
    sheet.drawing.add(std::move(path));
  }
  for (const FigureSeries& s : sheet.figure->series)
    if (!s.low.empty()) draw_band(sheet, s);
}

void draw_series(Sheet& sheet) {
  for (const bool behind : {true, false})
    for (const FigureSeries& s : sheet.figure->series) {
      if (s.behind != behind) continue;
      if (s.look.width > 0) draw_line(sheet, s);
      draw_markers(sheet, s);
    }
  for (const FigureWhisker& w : sheet.figure->whiskers) {
    const Place a = place_of(sheet, w.x0, w.y0), b = place_of(sheet, w.x1, w.y1);
    if (!is_place(a) || !is_place(b)) continue;
    DrawnPath path;
    path.lines = {{a, b}};
    path.stroke = colour_of(w.ink, sheet.grey);
    path.width = 0.9;
    path.clipped = true;
    sheet.drawing.add(std::move(path));
  }
}

void draw_bars(Sheet& sheet) {
  const double row = std::fabs(sheet.y.at(1) - sheet.y.at(0));
  for (const bool broad : {true, false})
    for (const FigureBar& bar : sheet.figure->bars) {
      if (bar.broad != broad) continue;
      const double middle = sheet.y.at(static_cast<double>(bar.row));
      const double half = row * (broad ? 0.44 : 0.13);
      const double from = sheet.x.at(std::max(bar.from, sheet.x.low));
      const double to = std::max(sheet.x.at(std::min(bar.to, sheet.x.high)), from + 0.7);
      DrawnPath path;
      path.filled = true;
      path.stroke = colour_of(bar.ink, sheet.grey);
      path.stroked = bar.hollow;
      path.width = 0.8;
      path.fill = broad ? pale(path.stroke, 0.45) : bar.hollow ? Colour{1, 1, 1} : path.stroke;
      path.clipped = true;
      path.lines = {{{from, middle - half}, {to, middle - half}, {to, middle + half}, {from, middle + half}}};
      sheet.drawing.add(std::move(path));
    }
}

}  // namespace libchar

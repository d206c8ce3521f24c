// The legend, and words beside marks: where they hide nothing.

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/figure/detail/scale.hpp"

namespace libchar {
namespace {

constexpr double kSwatch = 19, kGap = 3.5, kBetween = 9, kRow = 9.6;

/// A marker alone needs less room than a line.
double swatch_width(const LegendEntry& e) {
  return e.kind == LegendEntry::Kind::line && !(e.look.width > 0) ? 7 : kSwatch;
}

double entry_width(const LegendEntry& e) { return swatch_width(e) + kGap + text_width(text_runs(e.name), kLegendSize); }

/// Entries in rows.
std::vector<std::vector<const LegendEntry*>> in_rows(const std::vector<LegendEntry>& entries, double width) {
  std::vector<std::vector<const LegendEntry*>> rows;
  double used = 0;
  for (const LegendEntry& e : entries) {
    const double needed = entry_width(e) + (rows.empty() || rows.back().empty() ? 0 : kBetween);
    if (rows.empty() || used + needed > width) {
      rows.emplace_back();
      used = 0;
    }
    used += entry_width(e) + (rows.back().empty() ? 0 : kBetween);
    rows.back().push_back(&e);
  }
  return rows;
}

void draw_swatch(Sheet& sheet, const LegendEntry& e, double left, double middle) {
  const double width = swatch_width(e);
  DrawnPath path;
  path.stroke = colour_of(e.look.ink, sheet.grey);
  if (e.kind == LegendEntry::Kind::line) {
    path.lines = {{{left, middle}, {left + width, middle}}};
    path.width = e.look.width;
    path.dash = dash_of(e.look.dash);
    if (e.look.width > 0) sheet.drawing.add(std::move(path));
    add_marker(sheet, e.look, {{left + width / 2, middle}}, e.hollow);
    return;
  }
  const double half = e.kind == LegendEntry::Kind::bar ? 1.6 : 2.8;
  path.filled = true;
  path.stroked = e.hollow;
  path.width = 0.8;
  path.fill = e.hollow ? Colour{1, 1, 1} : path.stroke;
  path.opacity = e.opacity;
  path.lines = {
      {{left, middle - half}, {left + width, middle - half}, {left + width, middle + half}, {left, middle + half}}};
  sheet.drawing.add(std::move(path));
}

void draw_entry(Sheet& sheet, const LegendEntry& e, double left, double middle) {
  draw_swatch(sheet, e, left, middle);
  DrawnText text;
  text.at = {left + swatch_width(e) + kGap, middle + 0.36 * kLegendSize};
  text.size = kLegendSize;
  text.runs = text_runs(e.name);
  sheet.drawing.add(std::move(text));
}

std::size_t busy_in(const Sheet& sheet, const Box& box) {
  return static_cast<std::size_t>(
      std::count_if(sheet.busy.begin(), sheet.busy.end(), [&](const Place& p) { return box.holds(p); }));
}

bool is_free(const Sheet& sheet, const Box& box) {
  return std::none_of(sheet.taken.begin(), sheet.taken.end(), [&](const Box& b) { return b.meets(box); });
}

}  // namespace

std::vector<LegendEntry> legend_entries(const Chart& figure) {
  std::vector<LegendEntry> out;
  const auto add = [&](LegendEntry entry) {
    if (entry.name.empty()) return;
    if (std::none_of(out.begin(), out.end(), [&](const auto& e) { return e.name == entry.name; }))
      out.push_back(std::move(entry));
  };
  for (const FigureSeries& s : figure.series) {
    const bool hollow = !s.hollow.empty() && std::all_of(s.hollow.begin(), s.hollow.end(), [](bool h) { return h; });
    add({LegendEntry::Kind::line, s.name, s.look, hollow, 1});
    if (!s.low.empty()) add({LegendEntry::Kind::area, s.band, s.look, false, kBandOpacity});
  }
  for (const FigureStretch& s : figure.stretches)
    add({LegendEntry::Kind::area, s.name, {.ink = s.ink}, false, 2 * kStretchOpacity});
  for (const FigureBar& b : figure.bars)
    add({b.broad ? LegendEntry::Kind::area : LegendEntry::Kind::bar,
         b.name,
         {.ink = b.ink},
         b.hollow,
         b.broad ? 0.45 : 1});
  // One name says nothing that the axis does not say.
  if (out.size() == 1 && figure.bars.empty() && figure.marks.empty()) out.clear();
  return out;
}

double legend_height(const std::vector<LegendEntry>& entries, double width) {
  return kRow * static_cast<double>(in_rows(entries, width).size());
}

void draw_legend_below(Sheet& sheet, const std::vector<LegendEntry>& entries, const Box& room) {
  double middle = room.top + kRow / 2;
  for (const auto& row : in_rows(entries, room.right - room.left)) {
    double width = -kBetween;
    for (const LegendEntry* e : row) width += entry_width(*e) + kBetween;
    double left = (room.left + room.right - width) / 2;
    for (const LegendEntry* e : row) {
      draw_entry(sheet, *e, left, middle);
      left += entry_width(*e) + kBetween;
    }
    middle += kRow;
  }
}

bool draw_legend_inside(Sheet& sheet, const std::vector<LegendEntry>& entries, bool anyway) {
  constexpr double kInset = 4, kPad = 2.5;
  const Box& frame = sheet.drawing.frame;
  double width = 0;
  for (const LegendEntry& e : entries) width = std::max(width, entry_width(e));
  width += 2 * kPad;
  const double height = kRow * static_cast<double>(entries.size()) + 2 * kPad;
  if (!anyway && (width > 0.6 * (frame.right - frame.left) || height > 0.6 * (frame.bottom - frame.top))) return false;
  const double l = frame.left + kInset, r = frame.right - kInset - width, t = frame.top + kInset,
               b = frame.bottom - kInset - height;
  Box best{};
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const auto& [left, top] : {std::pair{r, t}, {l, b}, {l, t}, {r, b}}) {
    const Box box{left, top, left + width, top + height};
    const std::size_t hidden = busy_in(sheet, box) + (is_free(sheet, box) ? 0 : 50);
    if (hidden < least) {
      least = hidden;
      best = box;
    }
  }
  if (least > 0 && !anyway) return false;
  DrawnPath back;
  back.filled = true;
  back.stroked = false;
  back.fill = {1, 1, 1};
  back.opacity = 0.85;
  back.lines = {{{best.left, best.top}, {best.right, best.top}, {best.right, best.bottom}, {best.left, best.bottom}}};
  sheet.drawing.add(std::move(back));
  double middle = best.top + kPad + kRow / 2;
  for (const LegendEntry& e : entries) {
    draw_entry(sheet, e, best.left + kPad, middle);
    middle += kRow;
  }
  sheet.taken.push_back(best);
  return true;
}

namespace {

struct WordPlace {
  Box box;
  double ring = 0;
};

/// Places around a mark, nearest first.
std::vector<WordPlace> places_around(const Place& at, double width, double height, double reach) {
  std::vector<WordPlace> out;
  for (const double ring : {0.0, 1.0, 2.0, 3.0}) {
    const double d = reach + ring * 8, e = ring * 8;
    const double h = height / 2;
    const std::pair<double, double> corners[] = {{at.x + d, at.y - h},
                                                 {at.x - d - width, at.y - h},
                                                 {at.x - width / 2, at.y - d - height},
                                                 {at.x - width / 2, at.y + d},
                                                 {at.x + reach + 0.7 * e, at.y - h - reach - e},
                                                 {at.x + reach + 0.7 * e, at.y - h + reach + e},
                                                 {at.x - reach - 0.7 * e - width, at.y - h - reach - e},
                                                 {at.x - reach - 0.7 * e - width, at.y - h + reach + e}};
    for (const auto& [left, top] : corners) out.push_back({{left, top, left + width, top + height}, ring});
  }
  return out;
}

/// The place that hides least; none where all meet what stands already.
const WordPlace* best_place(const Sheet& sheet, const std::vector<WordPlace>& places) {
  const Box& frame = sheet.drawing.frame;
  const WordPlace* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const WordPlace& p : places) {
    const bool inside = p.box.left > frame.left + 1 && p.box.right < frame.right - 1 && p.box.top > frame.top + 1 &&
                        p.box.bottom < frame.bottom - 1;
    if (!inside || !is_free(sheet, p.box)) continue;
    const double cost = static_cast<double>(busy_in(sheet, p.box)) + 3 * p.ring;
    if (cost < least) {
      least = cost;
      best = &p;
    }
  }
  return best;
}

void draw_leader(Sheet& sheet, const Place& at, const Box& box, double reach, const FigureLook& look) {
  const Place to{std::clamp(at.x, box.left, box.right), std::clamp(at.y, box.top, box.bottom)};
  const double length = std::hypot(to.x - at.x, to.y - at.y);
  if (length < reach + 4) return;
  const double share = reach / length;
  DrawnPath path;
  path.lines = {{{at.x + share * (to.x - at.x), at.y + share * (to.y - at.y)}, to}};
  path.width = 0.4;
  path.stroke = colour_of(look.ink, sheet.grey);
  sheet.drawing.add(std::move(path));
}

}  // namespace

void draw_marks(Sheet& sheet) {
  const std::vector<FigureMark>& marks = sheet.figure->marks;
  std::vector<Place> at;
  for (const FigureMark& m : marks) {
    at.push_back({sheet.x.at(m.x), sheet.y.at(m.y)});
    const double r = m.look.size + 0.8;
    if (sheet.drawing.frame.holds(at.back()))
      sheet.taken.push_back({at.back().x - r, at.back().y - r, at.back().x + r, at.back().y + r});
  }
  for (std::size_t k = 0; k < marks.size(); ++k)
    if (sheet.drawing.frame.holds(at[k])) add_marker(sheet, marks[k].look, {at[k]}, marks[k].hollow, marks[k].tip);
  for (std::size_t k = 0; k < marks.size(); ++k) {
    const FigureMark& m = marks[k];
    if (m.text.empty() || !sheet.drawing.frame.holds(at[k])) continue;
    DrawnText text;
    text.runs = text_runs(m.text);
    text.size = kLegendSize;
    text.halo = true;
    const double reach = m.look.size + 2.2;
    const auto places = places_around(at[k], text_width(text.runs, text.size), 1.05 * kLegendSize, reach);
    const WordPlace* place = best_place(sheet, places);
    if (place == nullptr) continue;
    draw_leader(sheet, at[k], place->box, reach, m.look);
    text.at = {place->box.left, place->box.bottom - 0.25 * kLegendSize};
    sheet.taken.push_back(place->box);
    sheet.drawing.add(std::move(text));
  }
}

}  // namespace libchar

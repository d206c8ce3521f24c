
#include <algorithm>
#include <cmath>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/figure/detail/scale.hpp"

namespace libchar {
namespace {

constexpr double kPointsAMm = 72 / 25.4;
constexpr double kEdge = 2.5, kTickGap = 3, kTickLength = 2.4;
// Narrower or lower than this, an axis has no room for two ticks.
constexpr double kLeastFrame = 40;
constexpr double kLargestMm = 2000;

constexpr Colour kInkColours[] = {
    {0x00 / 255.0, 0x72 / 255.0, 0xb2 / 255.0}, {0xd5 / 255.0, 0x5e / 255.0, 0x00 / 255.0},
    {0x00 / 255.0, 0x9e / 255.0, 0x73 / 255.0}, {0xb0 / 255.0, 0x50 / 255.0, 0x8a / 255.0},
    {0xb3 / 255.0, 0x77 / 255.0, 0x00 / 255.0}, {0x3a / 255.0, 0x9f / 255.0, 0xd6 / 255.0},
    {0x16 / 255.0, 0x19 / 255.0, 0x1d / 255.0}, {0x8a / 255.0, 0x92 / 255.0, 0x9b / 255.0}};
constexpr double kInkGreys[] = {0.15, 0.45, 0.3, 0.55, 0.4, 0.6, 0.0, 0.6};

struct Margins {
  double left = 0, right = 0, top = 0, bottom = 0;
};

/// Without its middle, if it is too wide: names that begin alike end differently.
std::string shortened(const std::string& name, double width) {
  if (text_width(text_runs(name), kTickSize) <= width) return name;
  const auto begins_letter = [&](std::size_t at) {
    return at >= name.size() || (static_cast<unsigned char>(name[at]) & 0xC0U) != 0x80U;
  };
  std::size_t head = name.size() / 2, tail = head;
  const auto text = [&] { return name.substr(0, head) + "…" + name.substr(tail); };
  const auto trim = [&](bool from_head) {
    if (from_head && head > 0) --head;
    if (!from_head && tail < name.size()) ++tail;
    while (head > 0 && !begins_letter(head)) --head;
    while (!begins_letter(tail)) ++tail;
  };
  trim(true);
  while (head + name.size() - tail > 4 && text_width(text_runs(text()), kTickSize) > width)
    trim(head >= name.size() - tail);
  return text();
}

struct Axes {
  std::vector<Tick> x, y;
};

double widest(const std::vector<Tick>& ticks) {
  double out = 0;
  for (const Tick& t : ticks) out = std::max(out, text_width(text_runs(t.label), kTickSize));
  return out;
}

std::vector<Tick> row_ticks(const Chart& figure, double width) {
  std::vector<Tick> out;
  for (std::size_t k = 0; k < figure.y.rows.size(); ++k)
    out.push_back({static_cast<double>(k), shortened(figure.y.rows[k], 0.38 * width), true});
  return out;
}

std::vector<Tick> y_ticks(const Chart& figure, double width, double height) {
  if (!figure.y.rows.empty()) return row_ticks(figure, width);
  return axis_ticks(figure.y, height, figure.y.log ? 17 : 22);
}

std::vector<Tick> x_ticks(const Chart& figure, double width) {
  return axis_ticks(figure.x, width, figure.x.log ? 26 : 34);
}

Margins margins_of(const Chart& figure, const std::vector<Tick>& x, const std::vector<Tick>& y, double legend) {
  Margins m;
  m.left = kEdge + widest(y) + kTickGap + (figure.y.title.empty() ? 0 : 1.35 * kAxisSize + 1);
  // Half of the last word of the horizontal axis stands beyond the frame.
  m.right = kEdge + 3 + (x.empty() ? 0 : text_width(text_runs(x.back().label), kTickSize) / 2);
  m.top = kEdge + (figure.title.empty() ? 0.4 * kTickSize : kTitleSize + 5);
  m.bottom =
      kEdge + kTickGap + kTickSize + (figure.x.title.empty() ? 0 : 1.45 * kAxisSize) + (legend > 0 ? legend + 3 : 0);
  return m;
}

/// What suits the width: a frame of about four to three in a column, lower across two; rows as many as there are.
double frame_height(const Chart& figure, double width) {
  if (!figure.bars.empty()) return std::max(60.0, 25.0 * static_cast<double>(figure.y.rows.size()));
  if (!figure.y.rows.empty()) return std::max(60.0, 11.5 * static_cast<double>(figure.y.rows.size()));
  return width < 300 ? 0.62 * width : 0.38 * width;
}

void draw_grid(Sheet& sheet, const Axes& axes) {
  const Box& f = sheet.drawing.frame;
  for (const bool strong : {false, true}) {
    DrawnPath lines;
    lines.width = strong ? 0.45 : 0.3;
    const double level = strong ? 0.80 : 0.925;
    lines.stroke = {level, level, level};
    for (const Tick& t : axes.x)
      if (t.strong == strong) lines.lines.push_back({{sheet.x.at(t.value), f.top}, {sheet.x.at(t.value), f.bottom}});
    for (const Tick& t : axes.y)
      if (t.strong == strong) lines.lines.push_back({{f.left, sheet.y.at(t.value)}, {f.right, sheet.y.at(t.value)}});
    if (!lines.lines.empty()) sheet.drawing.add(std::move(lines));
  }
}

void draw_frame(Sheet& sheet, const Axes& axes) {
  const Box& f = sheet.drawing.frame;
  DrawnPath path;
  path.width = 0.6;
  path.stroke = {0.3, 0.3, 0.3};
  path.lines = {{{f.left, f.top}, {f.right, f.top}, {f.right, f.bottom}, {f.left, f.bottom}, {f.left, f.top}}};
  for (const Tick& t : axes.x) {
    const double length = t.strong ? kTickLength : kTickLength / 2, at = sheet.x.at(t.value);
    path.lines.push_back({{at, f.bottom}, {at, f.bottom - length}});
  }
  if (sheet.figure->y.rows.empty())
    for (const Tick& t : axes.y) {
      const double length = t.strong ? kTickLength : kTickLength / 2, at = sheet.y.at(t.value);
      path.lines.push_back({{f.left, at}, {f.left + length, at}});
    }
  sheet.drawing.add(std::move(path));
}

void add_text(Sheet& sheet, Place at, Anchor anchor, double size, const std::string& words, bool bold = false) {
  DrawnText text;
  text.at = at;
  text.anchor = anchor;
  text.size = size;
  text.bold = bold;
  text.runs = text_runs(words);
  sheet.drawing.add(std::move(text));
}

void draw_tick_words(Sheet& sheet, const Axes& axes) {
  const Box& f = sheet.drawing.frame;
  double free_from = 0;
  for (const Tick& t : axes.x) {
    if (t.label.empty()) continue;
    const double half = text_width(text_runs(t.label), kTickSize) / 2;
    // A word at the end of the axis stays on the page.
    const double at = std::min(sheet.x.at(t.value), sheet.drawing.width - kEdge - half);
    if (at - half < free_from) continue;
    free_from = at + half + 3;
    add_text(sheet, {at, f.bottom + kTickGap + 0.76 * kTickSize}, Anchor::middle, kTickSize, t.label);
  }
  for (const Tick& t : axes.y)
    if (!t.label.empty())
      add_text(sheet, {f.left - kTickGap, sheet.y.at(t.value) + 0.36 * kTickSize}, Anchor::end, kTickSize, t.label);
}

/// As large as fits the length of the axis.
double fitting(const std::string& words, double size, double length) {
  const double width = text_width(text_runs(words), size);
  return width > length ? std::max(0.6 * size, size * length / width) : size;
}

void draw_titles(Sheet& sheet) {
  const Chart& figure = *sheet.figure;
  const Box& f = sheet.drawing.frame;
  const double middle = (f.left + f.right) / 2;
  if (!figure.title.empty())
    add_text(sheet, {middle, f.top - 5}, Anchor::middle,
             fitting(figure.title, kTitleSize, 0.94 * 2 * std::min(middle, sheet.drawing.width - middle)), figure.title,
             true);
  if (!figure.x.title.empty())
    add_text(sheet, {middle, f.bottom + kTickGap + kTickSize + 1.1 * kAxisSize}, Anchor::middle, kAxisSize,
             figure.x.title);
  if (!figure.note.empty())
    add_text(sheet, {f.left + 4, f.top + 4 + 0.75 * kTickSize}, Anchor::start, kTickSize, figure.note);
  if (figure.y.title.empty()) return;
  DrawnText title;
  title.upright = true;
  title.anchor = Anchor::middle;
  title.size = fitting(figure.y.title, kAxisSize, sheet.drawing.height - 2 * kEdge);
  title.runs = text_runs(figure.y.title);
  const double half = text_width(title.runs, title.size) / 2;
  // Beside the frame's middle, and on the page.
  title.at = {kEdge + 0.8 * kAxisSize, std::clamp((f.top + f.bottom) / 2, kEdge + half,
                                                  std::max(kEdge + half, sheet.drawing.height - kEdge - half))};
  sheet.drawing.add(std::move(title));
}

/// Above each broad bar what it says, below each narrow one, where there is room in its row.
void draw_bar_notes(Sheet& sheet) {
  const double row = std::fabs(sheet.y.at(1) - sheet.y.at(0));
  if (row < 18) return;
  const Box& f = sheet.drawing.frame;
  for (const FigureBar& bar : sheet.figure->bars) {
    if (bar.note.empty()) continue;
    DrawnText text;
    text.runs = text_runs(bar.note);
    text.size = 6.5;
    text.halo = true;
    const double width = text_width(text.runs, text.size);
    const double left = std::clamp(sheet.x.at(std::max(bar.from, sheet.x.low)) + 2, f.left + 2,
                                   std::max(f.left + 2, f.right - width - 2));
    const double middle = sheet.y.at(static_cast<double>(bar.row)) + (bar.broad ? -0.28 : 0.29) * row;
    const Box box{left, middle - 3.2, left + width, middle + 3.2};
    if (std::any_of(sheet.taken.begin(), sheet.taken.end(), [&](const Box& b) { return b.meets(box); })) continue;
    sheet.taken.push_back(box);
    text.at = {left, middle + 0.36 * text.size};
    sheet.drawing.add(std::move(text));
  }
}

[[noreturn]] void refuse_size(double width_mm, double height_mm) {
  throw usage_error("E0981")
      .says("a page of {} × {} mm has no room for a plot with its axes, or is larger than {} mm",
            brief_text(width_mm, 4), brief_text(height_mm, 4), kLargestMm)
      .hint("one column is 85 mm wide, two are 178 mm");
}

Sheet make_sheet(const Chart& figure, const DrawingOptions& options, double legend, Axes& axes) {
  const double width = options.width_mm * kPointsAMm;
  if (!(options.width_mm > 0 && options.width_mm <= kLargestMm && options.height_mm >= 0 &&
        options.height_mm <= kLargestMm))
    refuse_size(options.width_mm, options.height_mm);
  double inner = options.shape > 0 ? options.shape * width : frame_height(figure, width);
  axes.y = y_ticks(figure, width, inner);
  axes.x = x_ticks(figure, width);
  Margins m = margins_of(figure, axes.x, axes.y, legend);
  const double height = options.height_mm > 0 ? options.height_mm * kPointsAMm : inner + m.top + m.bottom;
  inner = height - m.top - m.bottom;
  if (!(inner >= kLeastFrame && width - m.left - m.right >= kLeastFrame))
    refuse_size(options.width_mm, height / kPointsAMm);
  axes.y = y_ticks(figure, width, inner);
  m = margins_of(figure, axes.x, axes.y, legend);
  Sheet out;
  out.figure = &figure;
  out.grey = options.grey;
  out.drawing.width = width;
  out.drawing.height = height;
  out.drawing.about = figure.about;
  const Box frame{m.left, m.top, width - m.right, height - m.bottom};
  out.drawing.frame = frame;
  axes.x = x_ticks(figure, frame.right - frame.left);
  out.x = page_scale(figure.x, frame.left, frame.right);
  // Rows count downwards.
  out.y = figure.y.rows.empty() ? page_scale(figure.y, frame.bottom, frame.top)
                                : page_scale(figure.y, frame.top, frame.bottom);
  return out;
}

void draw_contents(Sheet& sheet, const Axes& axes) {
  DrawnPath paper;
  paper.filled = true;
  paper.stroked = false;
  paper.fill = {1, 1, 1};
  paper.lines = {
      {{0, 0}, {sheet.drawing.width, 0}, {sheet.drawing.width, sheet.drawing.height}, {0, sheet.drawing.height}}};
  sheet.drawing.add(std::move(paper));
  draw_grid(sheet, axes);
  draw_backgrounds(sheet);
  draw_bars(sheet);
  draw_series(sheet);
  draw_frame(sheet, axes);
  draw_bar_notes(sheet);
}

}  // namespace

Colour colour_of(Ink ink, bool grey) {
  const auto k = static_cast<std::size_t>(ink);
  if (!grey) return kInkColours[k];
  return {kInkGreys[k], kInkGreys[k], kInkGreys[k]};
}

Colour pale(Colour c, double share) {
  return {1 - share * (1 - c.red), 1 - share * (1 - c.green), 1 - share * (1 - c.blue)};
}

std::vector<double> dash_of(std::size_t number) {
  static const std::vector<double> kDashes[] = {
      {}, {4, 1.6}, {1.1, 1.5}, {5, 1.4, 1.1, 1.4}, {2.6, 1.1, 0.9, 1.1, 0.9, 1.1}, {7, 2.2}};
  return kDashes[number % std::size(kDashes)];
}

// Where the legend stands in a corner is known when the curves are drawn; where no corner is free,
// all is laid out again above it.
Drawing lay_out(const Chart& figure, const DrawingOptions& options) {
  std::vector<LegendEntry> entries =
      options.legend == LegendPlace::none ? std::vector<LegendEntry>{} : legend_entries(figure);
  // One name is never wider than the page.
  for (LegendEntry& e : entries) e.name = shortened(e.name, options.width_mm * kPointsAMm - 2 * kEdge - kLegendSwatch);
  Axes axes;
  if (options.legend != LegendPlace::below && !entries.empty()) {
    Sheet sheet = make_sheet(figure, options, 0, axes);
    draw_contents(sheet, axes);
    // Marks and their words need room too: a mark counts as much as a curve.
    for (const FigureMark& m : figure.marks) {
      const Place at{sheet.x.at(m.x), sheet.y.at(m.y)};
      sheet.taken.push_back({at.x - 5, at.y - 5, at.x + 5, at.y + 5});
    }
    const bool placed = draw_legend_inside(sheet, entries, options.legend == LegendPlace::inside);
    if (placed) {
      const Box legend = sheet.taken.back();
      sheet.taken = {legend};
      draw_marks(sheet);
      draw_tick_words(sheet, axes);
      draw_titles(sheet);
      return std::move(sheet.drawing);
    }
  }
  const double room = options.width_mm * kPointsAMm - 2 * kEdge;
  const double legend = entries.empty() ? 0 : legend_height(entries, room);
  Sheet sheet = make_sheet(figure, options, legend, axes);
  draw_contents(sheet, axes);
  draw_marks(sheet);
  draw_tick_words(sheet, axes);
  draw_titles(sheet);
  if (!entries.empty())
    draw_legend_below(sheet, entries,
                      {kEdge, sheet.drawing.height - kEdge - legend, kEdge + room, sheet.drawing.height});
  return std::move(sheet.drawing);
}

}  // namespace libchar

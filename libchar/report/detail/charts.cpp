#include "libchar/report/detail/charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/not_known.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/figure/draw_figure.hpp"
#include "libchar/report/detail/html/html_tables.hpp"

namespace libchar {
namespace {

/// An SVG of a page begins with its tag.
std::string with_class(const std::string& svg, const char* css) {
  return fmt::format("<svg class=\"{}\"", css) + svg.substr(4);
}

/// A window of 390 pixels has 350 for a drawing with letters of ten.
constexpr double kNarrowMm = 86;

/// Over the whole page; two side by side.
const DrawingOptions kWide{.width_mm = 165, .shape = 0.5, .legend = LegendPlace::below};
const DrawingOptions kHalf{.width_mm = kNarrowMm, .shape = 0.42, .legend = LegendPlace::none};

/// An axis on which quotients and differences are numbers.
FigureAxis axis_between(const std::string& title, bool log, double low, double high) {
  constexpr double kFar = 1e150;
  const double least = log ? 1 / kFar : -kFar;
  const auto near = [&](double end) { return end > least ? std::min(end, kFar) : least; };
  FigureAxis out{title, log, near(low), near(high), {}};
  if (!(out.high > out.low)) out.high = out.low + std::max(1e-9, std::abs(out.low));
  return out;
}

/// Smallest and largest of what has a place on a logarithmic axis.
struct LogExtent {
  double low = INFINITY, high = 0;
  void take(double value) {
    if (!(std::isfinite(value) && value > 0)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  FigureAxis axis(const std::string& title) const {
    const double margin = std::max(1.2, std::pow(high / low, 0.04));
    return axis_between(title, true, low / margin, high * margin);
  }
};

FigureSeries series_of(Ink ink, std::size_t dash, std::vector<double> x, std::vector<double> y) {
  FigureSeries out;
  out.look = {.ink = ink, .dash = dash, .width = 1};
  out.x = std::move(x);
  out.y = std::move(y);
  return out;
}

}  // namespace

std::string drawn_figure(const Chart& chart, const DrawingOptions& options, const std::string& caption) {
  DrawingOptions narrow = options;
  narrow.width_mm = kNarrowMm;
  narrow.shape = std::max(options.shape, 0.6);
  const bool once = options.width_mm <= kNarrowMm;
  return "<figure class=\"curves\">\n" + with_class(draw_figure(chart, options), once ? "any" : "wide") +
         (once ? "" : with_class(draw_figure(chart, narrow), "narrow")) + "<figcaption>" + html_text(caption) +
         "</figcaption>\n</figure>\n";
}

FigureSeries allan_series(const AllanCurve& allan, std::size_t k, const std::string& name, bool strong, double factor) {
  // Dashes repeat more slowly than colours.
  FigureSeries out = series_of(static_cast<Ink>(k % kSeriesInks), k / kSeriesInks, {}, {});
  out.name = out.tip = name;
  if (strong) out.look.width = 2;
  for (const AllanPoint& point : allan.points) {
    if (!point.reliable) continue;
    out.x.push_back(point.tau_s);
    out.y.push_back(factor * point.deviation);
  }
  return out;
}

std::string curves_figure(std::vector<FigureSeries> curves, const std::string& y_title, const std::string& about) {
  constexpr std::size_t kMostNamed = 16;
  LogExtent x, y;
  for (const FigureSeries& c : curves)
    for (std::size_t i = 0; i < c.x.size(); ++i) {
      if (!(c.x[i] > 0 && c.y[i] > 0)) continue;
      x.take(c.x[i]);
      y.take(c.y[i]);
    }
  if (x.high == 0 || y.high == 0) return "";
  std::size_t named = 0, more = 0;
  for (FigureSeries& c : curves)
    if (!c.name.empty() && ++named > kMostNamed && c.look.width < 2) {
      c.name.clear();
      ++more;
    }
  std::stable_partition(curves.begin(), curves.end(), [](const FigureSeries& c) { return c.look.width < 2; });
  Chart chart;
  chart.about = about;
  chart.x = x.axis("averaging time τ, s");
  chart.y = y.axis(y_title);
  chart.series = std::move(curves);
  return drawn_figure(chart, kWide, more > 0 ? fmt::format("{} more have no name here.", more) : "");
}

namespace {

/// Steps through the points of the front: what can be had for at most so much.
FigureSeries front_line(const BenchChart& chart, bool told) {
  std::vector<const BenchPoint*> front;
  for (const BenchPoint& p : chart.points)
    if (p.on_front && p.told == told) front.push_back(&p);
  std::sort(front.begin(), front.end(), [](const auto* a, const auto* b) { return a->x < b->x; });
  FigureSeries out = series_of(Ink::black, 1, {}, {});
  for (std::size_t i = 0; i < front.size(); ++i) {
    if (i > 0) {
      out.x.push_back(front[i]->x);
      out.y.push_back(front[i - 1]->y);
    }
    out.x.push_back(front[i]->x);
    out.y.push_back(front[i]->y);
  }
  return out;
}

void add_point(Chart& chart, const BenchPoint& p) {
  FigureMark mark{p.x, p.y, p.name, {}, p.told};
  mark.look = {
      .ink = p.is_ours ? Ink::blue : Ink::vermilion, .marker = FigureMarker::circle, .size = p.on_front ? 2.6 : 1.8};
  const auto known = [](const Interval& i) { return i.low > 0 && std::isfinite(i.high); };
  if (known(p.x95)) chart.whiskers.push_back({p.x95.low, p.y, p.x95.high, p.y, mark.look.ink});
  if (known(p.y95)) chart.whiskers.push_back({p.x, p.y95.low, p.x, p.y95.high, mark.look.ink});
  chart.marks.push_back(std::move(mark));
}

}  // namespace

std::string points_figure(const BenchChart& bench, const std::string& about) {
  Chart chart;
  LogExtent x, y;
  for (const BenchPoint& p : bench.points) {
    if (!(p.x > 0 && p.y > 0 && std::isfinite(p.x) && std::isfinite(p.y))) continue;
    for (const double end : {p.x, p.x95.low, p.x95.high}) x.take(end);
    for (const double end : {p.y, p.y95.low, p.y95.high}) y.take(end);
    add_point(chart, p);
  }
  if (chart.marks.empty()) return "";
  chart.about = about;
  chart.x = x.axis(bench.x);
  chart.y = y.axis(bench.y);
  chart.series = {front_line(bench, false), front_line(bench, true)};
  return drawn_figure(
      chart, kWide,
      "Lower and further left is better. Dashed: the front, where no other is better in both; large: on the front. "
      "Lines: 95 % intervals. Blue: this program; orange: recipes of others. Open: the terms are given; "
      "these have a separate front.");
}

namespace {

/// Of a place on the axis of a lot.
double value_at(const LotAxis& axis, double place) { return axis.logarithm ? std::exp(place) : place; }

/// Ends with a margin; a limit near the values belongs into the picture, one far away would squeeze them.
FigureAxis lot_axis(const LotAxis& axis, double low, double high) {
  if (axis.limit && *axis.limit < high + (high - low) && *axis.limit > low - (high - low)) {
    low = std::min(low, *axis.limit);
    high = std::max(high, *axis.limit);
  }
  if (!(high > low)) {
    const double half = std::max(std::abs(low) * 0.05, 1e-9);
    low -= half;
    high += half;
  }
  const double margin = 0.03 * (high - low);
  return axis_between(axis.title, axis.logarithm, value_at(axis, low - margin), value_at(axis, high + margin));
}

/// The limit where it is out of the picture.
std::string beyond_text(const LotAxis& axis, const FigureAxis& shown) {
  if (!axis.limit) return "";
  const double limit = value_at(axis, *axis.limit);
  if (limit >= shown.low && limit <= shown.high) return "";
  return fmt::format("The limit, {}, is further {}. ", number_text(limit, 3), limit > shown.high ? "up" : "down");
}

FigureMark word_at(double x, double y, const std::string& word) {
  return {x, y, word, {.ink = Ink::black, .size = 0}, false};
}

/// What the zone rules found, and whether that is more than chance brings.
std::string zones_text(const ControlChart& chart, std::size_t values) {
  if (!(chart.sigma > 0)) return "All values are alike.";
  const char* const names[kZoneRules] = {"beyond 3 σ (dashed)", "two of three beyond 2 σ", "four of five beyond 1 σ",
                                         "eight in a row on one side"};
  std::string list, alarms;
  for (std::size_t r = 0; r < kZoneRules; ++r) {
    const ZoneFinding& found = chart.zones.rule[r];
    list += fmt::format("{}{} {} ({})", r == 0 ? "" : ", ", names[r], count_text(found.signals),
                        number_text(found.by_chance, 2));
    if (found.alarm)
      alarms += fmt::format("{}{} ({})", alarms.empty() ? "" : ", ", names[r], probability_text(found.p));
  }
  const std::string end =
      alarms.empty()
          ? fmt::format("No alarm: {} % of charts with as many values show a signal although nothing changed.",
                        number_text(100 * chart.zones.any_by_chance, 2))
          : "Alarm, more than chance explains: " + alarms + ".";
  return fmt::format("{} values, mean and σ of the moving range. Signals (expected by chance): {}. {}",
                     count_text(values), list, end);
}

/// The values, or where very many lie.
FigureSeries charted(const ControlChart& chart, const LotAxis& axis) {
  FigureSeries out = series_of(Ink::blue, 0, {}, {});
  bool single = true;
  for (const ChartPoint& p : chart.points) {
    single = single && p.count == 1;
    out.x.push_back(static_cast<double>(p.first) + (static_cast<double>(p.count) + 1) / 2);
    out.y.push_back(value_at(axis, p.mean));
    out.low.push_back(value_at(axis, p.low));
    out.high.push_back(value_at(axis, p.high));
  }
  if (!single) return out;
  out.low.clear();
  out.high.clear();
  out.look.marker = FigureMarker::circle;
  return out;
}

/// Drawings stay small: of very many the furthest.
void add_beyond(Chart& out, const ControlChart& chart, const LotAxis& axis, const std::vector<std::string>& names) {
  constexpr std::size_t kMostMarks = 150;
  std::vector<std::size_t> order(chart.beyond.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(chart.beyond[a].value - chart.centre) > std::abs(chart.beyond[b].value - chart.centre);
  });
  if (order.size() > kMostMarks) order.resize(kMostMarks);
  for (const std::size_t i : order) {
    const ChartValue& v = chart.beyond[i];
    out.marks.push_back(word_at(static_cast<double>(v.index + 1), value_at(axis, v.value), ""));
    out.marks.back().look = {.ink = Ink::vermilion, .marker = FigureMarker::circle, .size = 2.2};
    out.marks.back().hollow = true;
    out.marks.back().tip = names[i];
  }
}

}  // namespace

std::string histogram_figure(const Histogram& h, const LotAxis& axis, const std::string& about) {
  if (h.count.empty()) return "";
  const auto edge = [&](double k) { return value_at(axis, h.low + h.step * k); };
  const auto most = static_cast<double>(*std::max_element(h.count.begin(), h.count.end()));
  Chart chart;
  chart.about = about;
  chart.x = lot_axis(axis, h.low, h.low + h.step * static_cast<double>(h.count.size()));
  chart.y = {"devices", false, 0, std::max(most, 4.0) * 1.12, {}};
  FigureSeries bars = series_of(Ink::blue, 0, {}, {});
  for (std::size_t k = 0; k < h.count.size(); ++k) {
    const auto left = static_cast<double>(k), count = static_cast<double>(h.count[k]);
    for (const double place : {edge(left + 0.03), edge(left + 0.97), kNone}) {
      bars.x.push_back(place);
      bars.y.push_back(count);
      bars.low.push_back(0);
      bars.high.push_back(count);
    }
  }
  chart.series = {std::move(bars)};
  const auto upright = [&](const std::optional<double>& place, Ink ink, const char* word) {
    if (!place) return;
    const double at = value_at(axis, *place);
    chart.whiskers.push_back({at, 0, at, chart.y.high, ink});
    chart.marks.push_back(word_at(at, 0.95 * chart.y.high, word));
  };
  upright(axis.mean, Ink::green, "mean");
  upright(axis.limit, Ink::vermilion, "limit");
  std::string caption = beyond_text(axis, chart.x) + "Histogram of the devices' values";
  if (h.below > 0) caption += fmt::format("; {} lower than shown", h.below);
  if (h.above > 0) caption += fmt::format("; {} higher than shown", h.above);
  return drawn_figure(chart, kHalf, caption + ".");
}

std::string control_figure(const ControlChart& control, std::size_t values, const LotAxis& axis,
                           const std::vector<std::string>& beyond, const std::vector<ChartBound>& bounds,
                           const std::string& about) {
  Chart chart;
  chart.about = about;
  // Counted from one.
  const double first = 0.5, last = static_cast<double>(values) + 0.5;
  chart.x = {"devices by batch and name", false, first, last, {}};
  double low = control.limits.low, high = control.limits.high;
  for (const ChartPoint& p : control.points) {
    low = std::min(low, p.low);
    high = std::max(high, p.high);
  }
  chart.y = lot_axis(axis, low, high);
  for (const ChartBound& bound : bounds) {
    const double at = static_cast<double>(bound.index) + 0.5;
    chart.whiskers.push_back({at, chart.y.low, at, chart.y.high, Ink::grey});
    if (bounds.size() <= 6) chart.marks.push_back(word_at(at, chart.y.high, bound.name));
  }
  const auto level = [&](double place, Ink ink, std::size_t dash) {
    const double at = value_at(axis, place);
    chart.series.push_back(series_of(ink, dash, {first, last}, {at, at}));
  };
  level(control.limits.low, Ink::orange, 1);
  level(control.limits.high, Ink::orange, 1);
  level(control.centre, Ink::green, 0);
  if (axis.limit) {
    level(*axis.limit, Ink::vermilion, 0);
    chart.marks.push_back(word_at(last, value_at(axis, *axis.limit), "limit"));
  }
  chart.series.push_back(charted(control, axis));
  add_beyond(chart, control, axis, beyond);
  return drawn_figure(chart, kHalf, beyond_text(axis, chart.y) + zones_text(control, values));
}

}  // namespace libchar

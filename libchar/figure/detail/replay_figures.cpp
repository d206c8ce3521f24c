// Error against cost: lower and further left is better. A method is on the front where no other is better in both.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/not_known.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/figure/detail/figure_parts.hpp"

namespace libchar {
namespace {

// Beyond so many times the best, marks stand on the edge: one method that diverged may not press all others together.
constexpr double kFarthest = 1000, kFarthestOfRanking = 30;

struct CostPoint {
  const ReplayReport::Algorithm* algorithm = nullptr;
  double cost = 0, score = 0;
  bool on_front = false, beyond = false;
};

/// What a method costs, and whether it is on the front of that cost.
struct CostKind {
  const char* kind;
  const char* title;
  double (*cost)(const ReplayReport::Algorithm& algorithm);
  bool ReplayReport::Algorithm::*on_front;
};

std::vector<CostPoint> cost_points(const ShownReplay& replay, const FigureOptions& options, const CostKind& kind) {
  refuse_unmatched_methods(replay, options);
  std::vector<CostPoint> out;
  double least = kNone;
  for (const ReplayReport::Algorithm* one : replay.ranked) {
    if (!is_wanted(options.channels, one->label)) continue;
    const double cost = kind.cost(*one);
    if (!above_zero(one->rmse) || !above_zero(cost)) continue;
    out.push_back({one, cost, one->rmse, one->*kind.on_front, false});
    least = std::fmin(least, one->rmse);
  }
  for (CostPoint& p : out)
    if (p.score > kFarthest * least) {
      p.score = kFarthest * least;
      p.beyond = true;
    }
  return out;
}

// What the methods on it do not reach lies below and left of it.
void add_staircase(Chart& figure, std::vector<CostPoint> points) {
  points.erase(std::remove_if(points.begin(), points.end(), [](const CostPoint& p) { return !p.on_front; }),
               points.end());
  if (points.empty()) return;
  std::sort(points.begin(), points.end(), [](const CostPoint& a, const CostPoint& b) { return a.cost < b.cost; });
  FigureSeries line;
  line.name = "Pareto front";
  line.look = {.ink = Ink::vermilion, .dash = 1, .width = 0.9};
  line.x = {points[0].cost};
  line.y = {figure.y.high};
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) {
      line.x.push_back(points[i].cost);
      line.y.push_back(points[i - 1].score);
    }
    line.x.push_back(points[i].cost);
    line.y.push_back(points[i].score);
  }
  line.x.push_back(figure.x.high);
  line.y.push_back(points.back().score);
  figure.series.push_back(std::move(line));
}

/// What the legend says of marks: a series without points.
FigureSeries legend_key(const std::string& name, FigureMarker marker, Ink ink, bool hollow) {
  FigureSeries out;
  out.name = name;
  out.look = {.ink = ink, .width = 0, .marker = marker, .size = 2.3};
  out.hollow = {hollow};
  return out;
}

void add_cost_marks(Chart& figure, const ShownReplay& replay, const std::vector<CostPoint>& points) {
  const auto look_of = [&](const CostPoint& p) {
    return FigureLook{.ink = p.algorithm->bound ? Ink::grey
                             : p.on_front       ? Ink::blue
                                                : Ink::sky,
                      .width = 0.9,
                      .marker = p.algorithm->bound    ? FigureMarker::triangle
                                : p.algorithm->learns ? FigureMarker::square
                                                      : FigureMarker::circle,
                      .size = p.algorithm->label == replay.report->best ? 3.4 : 2.3};
  };
  for (const CostPoint& p : points)
    figure.marks.push_back({p.cost, p.score,
                            p.algorithm->label + (p.beyond ? " ↑ " + number_text(p.algorithm->rmse, 3) : ""),
                            look_of(p), p.algorithm->bound});
  const auto key = [&](const char* name, FigureMarker marker, Ink ink, bool any_of_it) {
    if (any_of_it) figure.series.push_back(legend_key(name, marker, ink, ink == Ink::grey));
  };
  const auto any = [&](auto is) {
    return std::any_of(points.begin(), points.end(), [&](const CostPoint& p) { return is(*p.algorithm); });
  };
  key("needs no reference", FigureMarker::circle, Ink::blue,
      any([](const ReplayReport::Algorithm& a) { return !a.bound && !a.learns; }));
  key("learns from a reference", FigureMarker::square, Ink::blue,
      any([](const ReplayReport::Algorithm& a) { return !a.bound && a.learns; }));
  key("bound", FigureMarker::triangle, Ink::grey, any([](const ReplayReport::Algorithm& a) { return a.bound; }));
}

Chart cost_figure(std::span<const FigureSource> sources, const FigureOptions& options, const CostKind& kind) {
  const ShownReplay replay = shown_replay(sources[0], {});
  const std::vector<CostPoint> points = cost_points(replay, options, kind);
  if (points.empty())
    throw kind_refusal(sources[0], kind.kind)
        .says("no method has both an error and this cost (this replay measured no costs)");
  Chart out;
  Extent x(true), y(true);
  for (const CostPoint& p : points) {
    x.take(p.cost);
    y.take(p.score);
  }
  y.take(replay.optimum);
  x.pad(2.5);
  y.pad(std::max(1.2, std::pow(y.high() / y.low(), 0.08)));
  out.x = {.title = kind.title, .log = true, .rows = {}};
  out.y = {.title = axis_title(std::string(replay.report->score_words()), replay.unit), .log = true, .rows = {}};
  set_ends(out.x, x, options.x_range);
  set_ends(out.y, y, options.y_range);
  add_staircase(out, points);
  if (above_zero(replay.optimum))
    out.series.push_back(line_series("optimum of this scene", {out.x.low, out.x.high}, {replay.optimum, replay.optimum},
                                     {.ink = Ink::black, .dash = 2, .width = 0.7}));
  add_cost_marks(out, replay, points);
  out.about = fmt::format("{} against {}", replay.report->score_words(), kind.title);
  return out;
}

}  // namespace

Chart front_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  return cost_figure(sources, options,
                     {"front", "Run time [ns per sample]", [](const auto& a) { return a.ns_per_sample; },
                      &ReplayReport::Algorithm::on_time_front});
}

Chart memory_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  return cost_figure(sources, options,
                     {"memory", "Peak memory [bytes]", [](const auto& a) { return a.bytes(); },
                      &ReplayReport::Algorithm::on_memory_front});
}

namespace {

std::vector<const ReplayReport::Algorithm*> ranking_rows(const ShownReplay& replay, const FigureOptions& options) {
  refuse_unmatched_methods(replay, options);
  std::vector<const ReplayReport::Algorithm*> out;
  for (const ReplayReport::Algorithm* one : replay.ranked)
    if (above_zero(one->rmse) && is_wanted(options.channels, one->label)) out.push_back(one);
  return out;
}

/// The mark of one method with its interval; what lies beyond `farthest` stands there as a square with its number.
void add_ranking_row(Chart& chart, Extent& x, const ShownReplay& replay, const ReplayReport::Algorithm& one,
                     double farthest) {
  const auto row = static_cast<double>(chart.y.rows.size());
  const bool beyond = one.rmse > farthest, best = one.label == replay.report->best;
  const double at = std::min(one.rmse, farthest);
  const Interval& ci = one.rmse_ci95;
  if (!beyond && above_zero(ci.low) && above_zero(ci.high)) {
    chart.whiskers.push_back({ci.low, row, ci.high, row, Ink::black});
    x.take(ci.low);
    x.take(ci.high);
  }
  x.take(at);
  const bool equal = best || one.as_good_as_best;
  chart.marks.push_back({at,
                         row,
                         beyond ? number_text(one.rmse, 3) : "",
                         {.ink = one.bound ? Ink::grey
                                 : equal   ? Ink::blue
                                           : Ink::vermilion,
                          .width = 0.9,
                          .marker = beyond ? FigureMarker::square : FigureMarker::circle,
                          .size = best ? 3.0 : 2.2},
                         one.bound});
  chart.y.rows.push_back(one.label);
}

void add_ranking_line(Chart& chart, const char* name, double at, std::size_t dash, Ink ink) {
  if (above_zero(at))
    chart.series.push_back(
        line_series(name, {at, at}, {chart.y.low, chart.y.high}, {.ink = ink, .dash = dash, .width = 0.8}));
}

void add_ranking_keys(Chart& chart) {
  const auto any = [&](auto is) { return std::any_of(chart.marks.begin(), chart.marks.end(), is); };
  chart.series.push_back(legend_key("as good as the best", FigureMarker::circle, Ink::blue, false));
  if (any([](const FigureMark& m) { return m.hollow; }))
    chart.series.push_back(legend_key("bound", FigureMarker::circle, Ink::grey, true));
  if (any([](const FigureMark& m) { return m.look.marker == FigureMarker::square; }))
    chart.series.push_back(legend_key("beyond the axis", FigureMarker::square, Ink::vermilion, false));
}

}  // namespace

Chart ranking_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  const ShownReplay replay = shown_replay(sources[0], {});
  const std::vector<const ReplayReport::Algorithm*> rows = ranking_rows(replay, options);
  if (rows.empty()) throw kind_refusal(sources[0], "ranking").says("no method has a score");
  double least = kNone;
  for (const ReplayReport::Algorithm* one : rows) least = std::fmin(least, one->rmse);
  Chart out;
  Extent x(true);
  for (const ReplayReport::Algorithm* one : rows) add_ranking_row(out, x, replay, *one, kFarthestOfRanking * least);
  x.take(replay.optimum);
  x.pad(std::max(1.02, std::pow(x.high() / x.low(), 0.06)));
  out.x = {.title = axis_title(std::string(replay.report->score_words()), replay.unit), .log = true, .rows = {}};
  set_ends(out.x, x, options.x_range);
  out.y.low = -0.5;
  out.y.high = static_cast<double>(rows.size()) - 0.5;
  add_ranking_line(out, "optimum of this scene", replay.optimum, 2, Ink::black);
  if (replay.report->reference)
    for (const SensorResult& sensor : replay.report->sensors)
      if (sensor.name == replay.report->best_sensor)
        add_ranking_line(out, "best single sensor", sensor.error.rmse, 1, Ink::green);
  add_ranking_keys(out);
  out.about = fmt::format("{} of each method", replay.report->score_words());
  return out;
}

}  // namespace libchar

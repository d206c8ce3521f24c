// Error against cost: lower and further left is better. A method is on the front where no other is better in both.

#include "libchar/figure/detail/replay_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/not_known.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/figure/detail/figure_parts.hpp"
#include "libchar/figure/detail/sources/replay_report.hpp"

namespace libchar {
namespace {

// Beyond so many times the best, marks stand on the edge: one method that diverged may not press all others together.
constexpr double kFarthest = 1000, kFarthestOfRanking = 30;

struct CostPoint {
  const ShownAlgorithm* algorithm = nullptr;
  double cost = 0, score = 0;
  bool on_front = false, beyond = false;
};

void refuse_unmatched_methods(const ShownReplay& replay, const FigureOptions& options) {
  std::vector<std::string> labels;
  for (const ShownAlgorithm& one : replay.ranked) labels.push_back(one.label);
  refuse_unmatched(options.channels, labels, replay.file);
}

std::vector<CostPoint> cost_points(const ShownReplay& replay,
                                   const FigureOptions& options,
                                   const std::string& key,
                                   const std::string& front) {
  refuse_unmatched_methods(replay, options);
  std::vector<CostPoint> out;
  double least = kNone;
  for (const ShownAlgorithm& one : replay.ranked) {
    if (!is_wanted(options.channels, one.label)) continue;
    const double cost = one.map.number_or(key, kNone);
    if (!above_zero(one.score) || !above_zero(cost)) continue;
    const bool on_front = one.map.has("on_front") && one.map.map("on_front").flag_or(front, false);
    out.push_back({&one, cost, one.score, on_front, false});
    least = std::fmin(least, one.score);
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
  points.erase(
      std::remove_if(points.begin(), points.end(), [](const CostPoint& p) { return !p.on_front; }),
      points.end());
  if (points.empty()) return;
  std::sort(points.begin(), points.end(), [](const CostPoint& a, const CostPoint& b) {
    return a.cost < b.cost;
  });
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

/// A level line across the whole figure.
FigureSeries level_line(const Chart& figure, const std::string& name, double y, std::size_t dash) {
  FigureSeries out;
  out.name = name;
  out.x = {figure.x.low, figure.x.high};
  out.y = {y, y};
  out.look = {.ink = Ink::black, .dash = dash, .width = 0.7};
  return out;
}

/// What the legend says of marks: a series without points.
FigureSeries legend_key(const std::string& name, FigureMarker marker, Ink ink, bool hollow) {
  FigureSeries out;
  out.name = name;
  out.look = {.ink = ink, .width = 0, .marker = marker, .size = 2.3};
  out.hollow = {hollow};
  return out;
}

void add_cost_marks(Chart& figure,
                    const ShownReplay& replay,
                    const std::vector<CostPoint>& points) {
  const auto look_of = [&](const CostPoint& p) {
    return FigureLook{.ink = p.algorithm->bound ? Ink::grey
                             : p.on_front       ? Ink::blue
                                                : Ink::sky,
                      .width = 0.9,
                      .marker = p.algorithm->bound    ? FigureMarker::triangle
                                : p.algorithm->learns ? FigureMarker::square
                                                      : FigureMarker::circle,
                      .size = p.algorithm->label == replay.best ? 3.4 : 2.3};
  };
  for (const CostPoint& p : points)
    figure.marks.push_back(
        {p.cost,
         p.score,
         p.algorithm->label + (p.beyond ? " ↑ " + number_text(p.algorithm->score, 3) : ""),
         look_of(p),
         p.algorithm->bound});
  const auto key = [&](const char* name, FigureMarker marker, Ink ink, bool any_of_it) {
    if (any_of_it) figure.series.push_back(legend_key(name, marker, ink, ink == Ink::grey));
  };
  const auto any = [&](auto is) {
    return std::any_of(
        points.begin(), points.end(), [&](const CostPoint& p) { return is(*p.algorithm); });
  };
  key("needs no reference", FigureMarker::circle, Ink::blue, any([](const ShownAlgorithm& a) {
        return !a.bound && !a.learns;
      }));
  key("learns from a reference", FigureMarker::square, Ink::blue, any([](const ShownAlgorithm& a) {
        return !a.bound && a.learns;
      }));
  key("bound", FigureMarker::triangle, Ink::grey, any([](const ShownAlgorithm& a) {
        return a.bound;
      }));
}

Chart cost_figure(std::span<const FigureSource> sources,
                  const FigureOptions& options,
                  const std::string& key,
                  const std::string& front,
                  const std::string& title) {
  const ShownReplay replay = shown_replay(sources[0], {});
  const std::vector<CostPoint> points = cost_points(replay, options, key, front);
  if (points.empty())
    refuse_kind(sources[0],
                front == "time" ? "front" : "memory",
                "no method has both an error and this cost (a replay measures costs unless it is "
                "told not to)");
  Chart out;
  Extent x(true), y(true);
  for (const CostPoint& p : points) {
    x.take(p.cost);
    y.take(p.score);
  }
  y.take(replay.optimum);
  x.pad(2.5);
  y.pad(std::max(1.2, std::pow(y.high() / y.low(), 0.08)));
  out.x = {.title = title, .log = true, .rows = {}};
  out.y = {.title = axis_title(replay.score_name, replay.unit), .log = true, .rows = {}};
  set_ends(out.x, x, options.x_range);
  set_ends(out.y, y, options.y_range);
  add_staircase(out, points);
  if (above_zero(replay.optimum))
    out.series.push_back(level_line(out, "optimum of this scene", replay.optimum, 2));
  add_cost_marks(out, replay, points);
  out.about = replay.score_name + " against " + title;
  return out;
}

std::vector<double> interval_of(const ShownAlgorithm& one, bool rmse) {
  if (rmse) return report_numbers(one.map, "rmse_ci95", 2);
  const MapReader blind = one.map.map("without_reference");
  return report_numbers(blind, "predictive_ci95", 2);
}

}  // namespace

Chart front_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  return cost_figure(sources, options, "ns_per_sample", "time", "Run time [ns a sample]");
}

Chart memory_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  return cost_figure(sources, options, "peak_bytes", "memory", "Peak memory [bytes]");
}

namespace {

std::vector<const ShownAlgorithm*> ranking_rows(const ShownReplay& replay,
                                                const FigureOptions& options) {
  refuse_unmatched_methods(replay, options);
  std::vector<const ShownAlgorithm*> out;
  for (const ShownAlgorithm& one : replay.ranked)
    if (above_zero(one.score) && is_wanted(options.channels, one.label)) out.push_back(&one);
  return out;
}

/// The mark of one method with its interval; what lies beyond `farthest` stands there as a square with its number.
void add_ranking_row(Chart& chart,
                     Extent& x,
                     const ShownReplay& replay,
                     const ShownAlgorithm& one,
                     double farthest) {
  const auto row = static_cast<double>(chart.y.rows.size());
  const bool beyond = one.score > farthest, best = one.label == replay.best;
  const double at = std::min(one.score, farthest);
  const std::vector<double> ci =
      beyond ? std::vector<double>{} : interval_of(one, replay.score_name == "RMSE");
  if (ci.size() == 2 && above_zero(ci[0]) && above_zero(ci[1])) {
    chart.whiskers.push_back({ci[0], row, ci[1], row, Ink::black});
    x.take(ci);
  }
  x.take(at);
  const bool equal = best || one.map.flag_or("as_good_as_best", false);
  chart.marks.push_back({at,
                         row,
                         beyond ? number_text(one.score, 3) : "",
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
  if (!above_zero(at)) return;
  FigureSeries line;
  line.name = name;
  line.x = {at, at};
  line.y = {chart.y.low, chart.y.high};
  line.look = {.ink = ink, .dash = dash, .width = 0.8};
  chart.series.push_back(std::move(line));
}

void add_ranking_keys(Chart& chart) {
  const auto any = [&](auto is) { return std::any_of(chart.marks.begin(), chart.marks.end(), is); };
  chart.series.push_back(legend_key("as good as the best", FigureMarker::circle, Ink::blue, false));
  if (any([](const FigureMark& m) { return m.hollow; }))
    chart.series.push_back(legend_key("bound", FigureMarker::circle, Ink::grey, true));
  if (any([](const FigureMark& m) { return m.look.marker == FigureMarker::square; }))
    chart.series.push_back(
        legend_key("beyond the axis", FigureMarker::square, Ink::vermilion, false));
}

}  // namespace

Chart ranking_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  const ShownReplay replay = shown_replay(sources[0], {});
  const std::vector<const ShownAlgorithm*> rows = ranking_rows(replay, options);
  if (rows.empty()) refuse_kind(sources[0], "ranking", "no method has a score");
  double least = kNone;
  for (const ShownAlgorithm* one : rows) least = std::fmin(least, one->score);
  Chart out;
  Extent x(true);
  for (const ShownAlgorithm* one : rows)
    add_ranking_row(out, x, replay, *one, kFarthestOfRanking * least);
  x.take(replay.optimum);
  x.pad(std::max(1.02, std::pow(x.high() / x.low(), 0.06)));
  out.x = {.title = axis_title(replay.score_name, replay.unit), .log = true, .rows = {}};
  set_ends(out.x, x, options.x_range);
  out.y.low = -0.5;
  out.y.high = static_cast<double>(rows.size()) - 0.5;
  add_ranking_line(out, "optimum of this scene", replay.optimum, 2, Ink::black);
  if (replay.has_reference && replay.map.has("best_sensor"))
    for (const MapReader& sensor : replay.map.maps("sensors"))
      if (sensor.text_or("name", "") == replay.map.text_or("best_sensor", ""))
        add_ranking_line(out, "best single sensor", sensor.number_or("rmse", kNone), 1, Ink::green);
  add_ranking_keys(out);
  out.about = replay.score_name + " of each method";
  return out;
}

}  // namespace libchar

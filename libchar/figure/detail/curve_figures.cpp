// One curve is drawn with its interval, model, terms and coefficients; several with one colour, dash and marker each.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "libchar/characterize/compare/characterization_comparison.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/figure/detail/figure_parts.hpp"

namespace libchar {
namespace {

// More bands than these hide each other.
constexpr std::size_t kMostBands = 3;
// More lines than these cannot be told apart.
constexpr std::size_t kManyPoints = 60;

struct ChosenCurve {
  const SourceCurve* curve = nullptr;
  std::string name;
};

std::string source_name(std::span<const FigureSource> sources, std::size_t i, const FigureOptions& options) {
  return i < options.labels.size() ? options.labels[i] : sources[i].name;
}

/// What tells one from another: the file, the channel, or both.
std::string told_apart(const std::string& source, const std::string& channel, bool many_sources, bool many_channels) {
  if (!many_sources) return channel;
  return many_channels ? source + ": " + channel : source;
}

template <class Part>
std::string usual_name(const Part& part) {
  if constexpr (requires { part.unit; })
    return detail::usual_channel_name(part.channel, part.unit);
  else
    return part.channel;
}

template <class Part, class Usable>
std::vector<std::pair<const Part*, std::string>> chosen_parts(std::span<const FigureSource> sources,
                                                              const FigureOptions& options,
                                                              std::vector<Part> FigureSource::*parts, Usable usable) {
  std::vector<std::pair<const Part*, std::size_t>> found;
  std::vector<std::string> all;
  std::set<std::string> channels;
  for (std::size_t s = 0; s < sources.size(); ++s)
    for (const Part& part : sources[s].*parts) {
      if (!usable(part)) continue;
      const std::string usual = usual_name(part);
      all.push_back(part.channel);
      if (usual != part.channel) all.push_back(usual);
      if (!is_wanted(options.channels, part.channel) && !is_wanted(options.channels, usual)) continue;
      found.emplace_back(&part, s);
      channels.insert(sources.size() > 1 ? usual : part.channel);
    }
  if (!all.empty()) refuse_unmatched(options.channels, all, sources[0].file);
  std::set<std::size_t> used;
  for (const auto& [part, s] : found) used.insert(s);
  std::vector<std::pair<const Part*, std::string>> out;
  out.reserve(found.size());
  for (const auto& [part, s] : found)
    out.emplace_back(part, told_apart(source_name(sources, s, options), part->channel,
                                      used.size() > 1 || !options.labels.empty(), channels.size() > 1));
  return out;
}

bool of_one_kind(const SourceCurve::Statistic& a, const SourceCurve::Statistic& b) {
  return a == b || (a.is_allan && b.is_allan);
}

std::set<std::string> statistics_of(const std::vector<ChosenCurve>& chosen, const std::string& name) {
  std::set<std::string> found;
  for (const ChosenCurve& one : chosen)
    if (one.name == name) found.insert(one.curve->statistic.title);
  return found;
}

/// Several statistics of one curve each (allan --type oadev,mdev) are meant to be seen beside each other, and are told
/// apart by their names; of which curve is meant is said too where there are several.
void name_by_statistic(std::vector<ChosenCurve>& chosen) {
  std::set<std::string> names;
  for (const ChosenCurve& one : chosen) names.insert(one.name);
  if (std::all_of(names.begin(), names.end(),
                  [&](const std::string& name) { return statistics_of(chosen, name).size() == 1; }))
    return;
  for (ChosenCurve& one : chosen)
    one.name = names.size() == 1 ? one.curve->statistic.title : one.name + ", " + one.curve->statistic.title;
}

/// A pattern for channels like this one and unlike another: "gyr*" for gyro_x, "*/Gyr*" for "IMU 0/GyrX", "imu1_g*"
/// for imu1_gyr_x beside imu1_acc_x.
std::string pattern_like(const std::string& channel, const std::string& unlike) {
  constexpr std::size_t kShortest = 3;
  const auto own_name = [](const std::string& name) { return name.substr(name.rfind('/') + 1); };
  const std::string own = own_name(channel), other = own_name(unlike);
  const auto apart = std::mismatch(own.begin(), own.end(), other.begin(), other.end()).first - own.begin();
  const std::size_t length = std::max(kShortest, static_cast<std::size_t>(apart) + 1);
  return (own == channel ? "" : "*/") + own.substr(0, length) + "*";
}

void refuse_unlike(const std::vector<ChosenCurve>& chosen) {
  const ChosenCurve& first = chosen[0];
  for (const ChosenCurve& other : chosen) {
    if (other.curve->unit != first.curve->unit)
      throw input_error("E0976")
          .says("curves in different units do not share an axis: {} in {}, {} in {}", first.name,
                first.curve->unit.empty() ? "1" : first.curve->unit, other.name,
                other.curve->unit.empty() ? "1" : other.curve->unit)
          .hint("choose some with `channels` ('{}'), a figure for each unit",
                pattern_like(first.curve->channel, other.curve->channel));
    if (other.curve->value_unit != first.curve->value_unit && other.curve->statistic != first.curve->statistic &&
        other.curve->is_allan)
      throw input_error("E0976")
          .says("curves in different units do not share an axis: {} in {}, {} in {}", first.curve->statistic.title,
                first.curve->value_unit, other.curve->statistic.title, other.curve->value_unit)
          .hint("a figure for each unit");
    const SourceCurve::Statistic &a = first.curve->statistic, &b = other.curve->statistic;
    if (!of_one_kind(a, b) && statistics_of(chosen, first.name) != statistics_of(chosen, other.name))
      throw input_error("E0983")
          .says("different curves do not share an axis: {} is {}, {} is {}", first.name, a.title, other.name, b.title)
          .hint("compute both in the same way");
  }
  if (chosen.size() > detail::kMostCurves)
    throw usage_error("E0984")
        .says("{} curves: more than {} cannot be distinguished in one figure", chosen.size(), detail::kMostCurves)
        .hint("choose some with `channels`");
}

std::vector<ChosenCurve> chosen_curves(std::span<const FigureSource> sources, const FigureOptions& options,
                                       bool is_allan) {
  std::vector<ChosenCurve> out;
  for (const auto& [curve, name] : chosen_parts(sources, options, &FigureSource::curves,
                                                [&](const SourceCurve& c) { return c.is_allan == is_allan; }))
    out.push_back({curve, name});
  if (out.empty())
    throw kind_refusal(sources[0], is_allan ? "allan" : "psd")
        .says(is_allan ? "it holds no Allan curve" : "it holds no spectrum");
  refuse_unlike(out);
  name_by_statistic(out);
  return out;
}

FigureSeries measured_series(const ChosenCurve& chosen, bool alone) {
  const SourceCurve& c = *chosen.curve;
  FigureSeries out;
  out.name = alone ? "measured" : chosen.name;
  out.x = c.x;
  out.y = c.y;
  out.hollow = c.unreliable;
  return out;
}

void set_band(FigureSeries& series, const SourceCurve& c) {
  series.low = c.low95;
  series.high = c.high95;
  if (!series.low.empty()) series.band = "95 % interval";
}

void add_terms(Chart& figure, const SourceCurve& c) {
  for (const Asymptote& line : c.lines) {
    figure.series.push_back(line_series(term_words(line.term), {line.x.begin(), line.x.end()},
                                        {line.y.begin(), line.y.end()},
                                        {.ink = term_ink(line.term), .dash = term_dash(line.term), .width = 0.8}));
    figure.series.back().behind = true;
  }
}

void add_coefficients(Chart& figure, const SourceCurve& c) {
  for (const SourceMark& mark : c.marks)
    if (above_zero(mark.tau_s) && above_zero(mark.deviation))
      figure.marks.push_back({mark.tau_s,
                              mark.deviation,
                              mark.text,
                              {.ink = term_ink(mark.term), .width = 0.9, .marker = term_marker(mark.term), .size = 2.9},
                              true});
}

/// A curve with all that belongs to it.
void draw_alone(Chart& figure, const ChosenCurve& chosen) {
  const SourceCurve& c = *chosen.curve;
  FigureSeries measured = measured_series(chosen, true);
  set_band(measured, c);
  if (c.of_model) measured.name = "model";
  measured.look = {.ink = Ink::blue, .width = 1.2};
  if (c.is_allan && !c.of_model) {
    measured.look.width = 0;
    measured.look.marker = FigureMarker::circle;
    measured.look.size = c.x.size() > kManyPoints ? 1.1 : 1.6;
  } else if (!c.of_model) {
    measured.look.width = 0.7;
  }
  for (const Interval& out : c.left_out)
    figure.stretches.push_back({out.low, out.high, c.is_allan ? "shaped spectrum" : "left out", Ink::grey});
  figure.series.push_back(std::move(measured));
  if (!c.model.empty())
    figure.series.push_back(
        line_series("fitted model", c.x, c.model, {.ink = Ink::vermilion, .dash = 0, .width = 1.2}));
  if (!c.data_sheet.empty())
    figure.series.push_back(line_series("data sheet", c.x, c.data_sheet, {.ink = Ink::black, .dash = 3, .width = 1}));
  if (!c.simulated_x.empty() && c.is_allan) {
    figure.series.push_back(line_series("simulated from the model", c.simulated_x, c.simulated_y,
                                        {.ink = Ink::grey, .width = 0, .marker = FigureMarker::triangle, .size = 2.1}));
    figure.series.back().hollow.assign(c.simulated_x.size(), true);
    figure.series.back().behind = true;
  }
  add_terms(figure, c);
  add_coefficients(figure, c);
}

void draw_many(Chart& figure, const std::vector<ChosenCurve>& chosen) {
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const SourceCurve& c = *chosen[k].curve;
    FigureSeries series = measured_series(chosen[k], false);
    series.look = series_look(k);
    if (chosen.size() <= kMostBands) {
      set_band(series, c);
      if (k + 1 < chosen.size()) series.band = "";
    }
    if (c.of_model) series.look.marker = FigureMarker::none;
    if (!c.is_allan || c.x.size() > kManyPoints) {
      series.look.marker = FigureMarker::none;
      series.look.width = 0.9;
    }
    figure.series.push_back(std::move(series));
  }
}

// What is measured, intervals up to a factor of three beyond it, models and marks up to thirty:
// none of them may press it into a corner.
void frame(Chart& figure, const std::vector<ChosenCurve>& chosen, const FigureOptions& options) {
  const bool allan = chosen[0].curve->is_allan;
  Extent x(true), measured(true);
  for (const ChosenCurve& one : chosen)
    for (std::size_t i = 0; i < one.curve->x.size(); ++i)
      if (above_zero(one.curve->x[i]) && above_zero(one.curve->y[i])) {
        x.take(one.curve->x[i]);
        measured.take(one.curve->y[i]);
      }
  Extent y = measured;
  const bool alone = chosen.size() == 1;
  for (const ChosenCurve& one : chosen) {
    if (chosen.size() > kMostBands) break;
    for (const auto* ends : {&one.curve->low95, &one.curve->high95})
      for (const double v : *ends) y.take_near(v, measured, allan ? 3 : 2);
  }
  if (alone) {
    for (const double v : chosen[0].curve->model) y.take_near(v, measured, allan ? 30 : 100);
    for (const SourceMark& mark : chosen[0].curve->marks) {
      x.take(mark.tau_s);
      if (mark.deviation > measured.low() / 30) y.take(mark.deviation);
    }
  }
  x.pad(allan ? 1.4 : 1.1);
  y.pad(allan ? 1.6 : 1.8);
  set_ends(figure.x, x, options.x_range);
  set_ends(figure.y, y, options.y_range);
}

Chart curves_figure(std::span<const FigureSource> sources, const FigureOptions& options, bool is_allan) {
  const std::vector<ChosenCurve> chosen = chosen_curves(sources, options, is_allan);
  const SourceCurve& first = *chosen[0].curve;
  Chart out;
  const auto all = [&](auto&& alike) {
    return std::all_of(chosen.begin(), chosen.end(),
                       [&](const ChosenCurve& one) { return alike(one.curve->statistic, first.statistic); });
  };
  const std::string statistic = all(std::equal_to<>()) ? first.statistic.title
                                : all(of_one_kind)     ? "Allan deviation"
                                                       : "Deviation";
  out.x = {.title = is_allan ? "Averaging time τ [s]" : "Frequency [Hz]", .log = true, .rows = {}};
  out.y = {.title = axis_title(statistic, first.value_unit), .log = true, .rows = {}};
  const bool alone = chosen.size() == 1;
  if (alone)
    draw_alone(out, chosen[0]);
  else
    draw_many(out, chosen);
  frame(out, chosen, options);
  out.about = statistic + " of " + (alone ? first.channel : fmt::format("{} curves", chosen.size()));
  return out;
}

}  // namespace

Chart allan_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  return curves_figure(sources, options, true);
}

Chart psd_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  return curves_figure(sources, options, false);
}

namespace {

bool is_fitted(const SourceResiduals& r, std::size_t i) {
  return above_zero(r.x[i]) && std::isfinite(r.z[i]) && (r.outside.empty() || !r.outside[i]);
}

/// In which 95 % of the residuals of a right model lie.
FigureSeries residual_band(const FigureAxis& x) {
  FigureSeries out;
  out.x = {x.low, x.high};
  out.y = {0, 0};
  out.low = {-1.96, -1.96};
  out.high = {1.96, 1.96};
  out.band = "95 % of a right model";
  out.look = {.ink = Ink::grey, .width = 0.8};
  return out;
}

/// One wild bin may not flatten the rest: what is beyond `top` stands on the edge, as a triangle. How many do.
std::size_t add_residual_dots(Chart& chart, const SourceResiduals& r, FigureSeries dots, double top) {
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < r.x.size(); ++i) {
    if (!is_fitted(r, i)) continue;
    if (std::fabs(r.z[i]) <= top) {
      dots.x.push_back(r.x[i]);
      dots.y.push_back(r.z[i]);
      continue;
    }
    ++beyond;
    chart.marks.push_back({r.x[i],
                           std::copysign(0.96 * top, r.z[i]),
                           "",
                           {.ink = Ink::vermilion,
                            .width = 0.8,
                            .marker = r.z[i] > 0 ? FigureMarker::triangle : FigureMarker::down,
                            .size = 2.4}});
  }
  chart.series.push_back(std::move(dots));
  return beyond;
}

}  // namespace

Chart residuals_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  constexpr double kLargest = 20;
  const auto chosen =
      chosen_parts(sources, options, &FigureSource::residuals, [](const SourceResiduals&) { return true; });
  if (chosen.empty()) throw kind_refusal(sources[0], "residuals").says("it holds no residuals of a fit");
  Chart out;
  Extent x(true);
  double largest = 0;
  for (const auto& [r, name] : chosen)
    for (std::size_t i = 0; i < r->x.size(); ++i)
      if (is_fitted(*r, i)) {
        x.take(r->x[i]);
        largest = std::max(largest, std::fabs(r->z[i]));
      }
  const double top = std::min(kLargest, std::max(4.0, std::ceil(1.05 * largest)));
  x.pad(1.2);
  out.x = {.title = "Frequency [Hz]", .log = true, .rows = {}};
  out.y = {.title = "Residual [standard deviations]", .low = -top, .high = top, .rows = {}};
  set_ends(out.x, x, options.x_range);
  if (options.y_range) {
    Extent y(false);
    y.take(-top);
    y.take(top);
    set_ends(out.y, y, options.y_range);
  }
  out.series.push_back(residual_band(out.x));
  std::size_t beyond = 0;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    FigureSeries dots;
    dots.name = chosen.size() > 1 ? chosen[k].second : "residuals";
    dots.look = series_look(k);
    dots.look.width = 0;
    dots.look.size = 1.2;
    beyond += add_residual_dots(out, *chosen[k].first, std::move(dots), top);
  }
  if (beyond > 0)
    out.note = fmt::format("{} beyond ±{}, up to {}", beyond, number_text(top, 2), number_text(largest, 3));
  out.about = "Residuals of the fit of " + chosen[0].second;
  return out;
}

namespace {

/// All have one colour: one mark as it is called, several by their kinds ("5 × step, warm-up, quietest").
std::string marks_name(const std::vector<TraceMark>& marks) {
  if (marks.size() == 1) return marks[0].label;
  std::vector<std::pair<std::string, std::size_t>> kinds;
  for (const TraceMark& mark : marks) {
    const auto known =
        std::find_if(kinds.begin(), kinds.end(), [&](const auto& one) { return one.first == mark.kind; });
    known == kinds.end() ? void(kinds.emplace_back(mark.kind, 1)) : void(++known->second);
  }
  std::string out;
  for (const auto& [kind, count] : kinds)
    out += (out.empty() ? "" : ", ") + (count > 1 ? fmt::format("{} × {}", count, kind) : kind);
  return out;
}

}  // namespace

Chart trace_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  const auto chosen = chosen_parts(sources, options, &FigureSource::traces, [](const SourceTrace&) { return true; });
  if (chosen.empty()) throw kind_refusal(sources[0], "trace").says("it holds no recording");
  Chart out;
  Extent x(false), y(false);
  double end_s = 0;
  for (const auto& [trace, name] : chosen)
    end_s = std::max(end_s, static_cast<double>(trace->low.size()) * trace->block_s);
  const auto [unit_s, unit] = time_unit_for(end_s);
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const auto& [trace, name] = chosen[k];
    if (trace->unit != chosen[0].first->unit)
      throw input_error("E0976")
          .says("recordings in different units do not share an axis: {} in {}, {} in {}", chosen[0].second,
                chosen[0].first->unit, name, trace->unit)
          .hint("choose some with `channels` ('{}'), a figure for each unit", pattern_like(chosen[0].second, name));
    FigureSeries series;
    series.name = chosen.size() > 1 ? name : "";
    for (std::size_t i = 0; i < trace->low.size(); ++i)
      add_extremes(series, (static_cast<double>(i) + 0.5) * trace->block_s / unit_s, trace->low[i], trace->high[i]);
    series.look = series_look(k);
    series.look.marker = FigureMarker::none;
    series.look.width = 0.5;
    y.take(series.y);
    if (chosen.size() == 1)
      for (const TraceMark& mark : trace->marks)
        out.stretches.push_back({mark.from_s / unit_s, mark.to_s / unit_s, marks_name(trace->marks), Ink::orange});
    out.series.push_back(std::move(series));
  }
  x.take(0.0);
  x.take(end_s / unit_s);
  y.pad(0.05);
  out.x = {.title = fmt::format("Time [{}]", unit), .rows = {}};
  out.y = {.title = axis_title(chosen.size() > 1 ? "Record" : chosen[0].second, chosen[0].first->unit), .rows = {}};
  set_ends(out.x, x, options.x_range);
  set_ends(out.y, y, options.y_range);
  out.about = "The record of " + chosen[0].second;
  return out;
}

}  // namespace libchar

// What is drawn over the run of a replay.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libchar/core/not_known.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/figure/detail/figure_parts.hpp"
#include "libchar/figure/detail/replay_figures.hpp"
#include "libchar/figure/detail/sources/replay_report.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostSensors = 24;

/// The part of a list of inputs that is about the input that is drawn.
MapReader of_input(const MapReader& map, const ShownReplay& replay) {
  std::vector<MapReader> all = map.maps("inputs");
  if (replay.input >= all.size()) map.refuse("inputs", "the list is too short");
  return all[replay.input];
}

/// The run, or the stretch of it of which every instant was kept and that holds all that is asked for.
MapReader run_shown(const ShownReplay& replay, const FigureOptions& options) {
  MapReader run = replay.map.map("run");
  if (!options.x_range || !run.has("close_ups")) return run;
  for (MapReader& close : run.maps("close_ups"))
    if (close.number("from_s") <= options.x_range->low * replay.time_unit_s &&
        close.number("to_s") >= options.x_range->high * replay.time_unit_s)
      return close;
  return run;
}

/// A signal that swings through most of its range within each stretch of the whole run would be a filled rectangle.
bool hides_itself(const ReportTrack& track) {
  constexpr double kMostOfRange = 0.5;
  if (track.low.empty()) return false;
  Extent all(false);
  all.take(track.low[0]);
  all.take(track.high[0]);
  std::vector<double> spans;
  for (std::size_t i = 0; i < track.low[0].size(); ++i)
    if (std::isfinite(track.low[0][i]) && std::isfinite(track.high[0][i]))
      spans.push_back(track.high[0][i] - track.low[0][i]);
  if (spans.empty()) return false;
  const auto middle = spans.begin() + static_cast<std::ptrdiff_t>(spans.size() / 2);
  std::nth_element(spans.begin(), middle, spans.end());
  return *middle > kMostOfRange * (all.high() - all.low());
}

/// Where nothing else is asked and the whole run hides itself: the stretch in which the first fault
/// begins, else the first that was kept with every instant.
FigureOptions with_readable_stretch(const ShownReplay& replay, FigureOptions options) {
  const MapReader run = replay.map.map("run");
  if (options.x_range || !run.has("close_ups")) return options;
  const ReportTrack whole =
      report_track(of_input(run, replay), "estimate", report_numbers(run, "time_s"));
  if (!hides_itself(whole)) return options;
  double fault_s = kNone;
  if (replay.map.has("faults"))
    for (const MapReader& fault : replay.map.maps("faults"))
      fault_s = std::fmin(fault_s, fault.number("from_s"));
  for (const bool any : {false, true})
    for (const MapReader& close : run.maps("close_ups")) {
      const double from = close.number("from_s"), to = close.number("to_s");
      if (!(from < to) || (!any && !(from <= fault_s && fault_s <= to))) continue;
      options.x_range = Interval{from / replay.time_unit_s, to / replay.time_unit_s};
      return options;
    }
  return options;
}

struct RunWords {
  std::string method, sensor;
};

RunWords words_of_run(const ShownReplay& replay) {
  const MapReader run = replay.map.map("run");
  return {run.text_or("method", "estimate"), run.text_or("sensor", "")};
}

void take_series(Extent& y, const FigureSeries& series, const FigureAxis& x) {
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (series.x[i] < x.low || series.x[i] > x.high) continue;
    y.take(series.y[i]);
    if (series.low.empty()) continue;
    y.take(series.low[i]);
    y.take(series.high[i]);
  }
}

void refuse_without_run(const FigureSource& source, const ShownReplay& replay, const char* kind) {
  if (!replay.map.has("run")) refuse_kind(source, kind, "nothing was estimated over its run");
}

const FigureLook kReferenceLook{.ink = Ink::black, .dash = 0, .width = 1.3};
const FigureLook kEstimateLook{.ink = Ink::vermilion, .dash = 0, .width = 0.6};
const FigureLook kSensorLook{.ink = Ink::sky, .dash = 0, .width = 0.5};

/// A signal as all its samples would look.
FigureSeries signal_series(const std::string& name,
                           const ReportTrack& track,
                           const ShownReplay& replay,
                           const FigureLook& look) {
  FigureSeries out;
  out.name = name;
  out.look = look;
  if (track.low.empty()) return out;
  for (std::size_t i = 0; i < track.time_s.size(); ++i)
    add_extremes(out, track.time_s[i] / replay.time_unit_s, track.low[0][i], track.high[0][i]);
  return out;
}

void set_value_axis(Chart& figure,
                    const std::string& words,
                    const std::string& unit,
                    Extent y,
                    const FigureOptions& options,
                    double pad) {
  y.pad(pad);
  figure.y.title = axis_title(words, unit);
  set_ends(figure.y, y, options.y_range);
}

}  // namespace

Chart timeline_figure(std::span<const FigureSource> sources, const FigureOptions& asked) {
  const ShownReplay replay = shown_replay(sources[0], asked);
  refuse_without_run(sources[0], replay, "timeline");
  const FigureOptions options = with_readable_stretch(replay, asked);
  const MapReader run = run_shown(replay, options);
  const RunWords words = words_of_run(replay);
  const std::vector<double> time = report_numbers(run, "time_s");
  Chart out;
  set_time_axis(out, replay, options);
  add_run_marks(out, replay);
  const MapReader input = of_input(run, replay);
  const ReportTrack sensor = report_track(run, "sensor_value", time),
                    reference = report_track(input, "reference", time);
  if (!reference.empty())
    out.series.push_back(signal_series("reference", reference, replay, kReferenceLook));
  if (!sensor.empty())
    out.series.push_back(signal_series("best sensor " + words.sensor, sensor, replay, kSensorLook));
  out.series.push_back(
      signal_series(words.method, report_track(input, "estimate", time), replay, kEstimateLook));
  Extent y(false);
  for (const FigureSeries& series : out.series) take_series(y, series, out.x);
  set_value_axis(out, replay.input_name, replay.unit, y, options, 0.06);
  out.about = "The run: reference, estimate and best sensor";
  return out;
}

Chart error_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  const ShownReplay replay = shown_replay(sources[0], options);
  refuse_without_run(sources[0], replay, "error");
  const MapReader run = run_shown(replay, options);
  const RunWords words = words_of_run(replay);
  const std::vector<double> time = report_numbers(run, "time_s");
  const ReportTrack error = report_track(of_input(run, replay), "error", time),
                    sensor = report_track(run, "sensor_error", time);
  if (error.empty())
    refuse_kind(sources[0], "error", "without a reference there is no error over the run");
  Chart out;
  set_time_axis(out, replay, options);
  add_run_marks(out, replay);
  if (!sensor.empty())
    out.series.push_back(signal_series("best sensor " + words.sensor, sensor, replay, kSensorLook));
  out.series.push_back(signal_series(words.method, error, replay, kEstimateLook));
  Extent y(false);
  for (const FigureSeries& series : out.series) take_series(y, series, out.x);
  set_value_axis(out, "Estimate − reference", replay.unit, y, options, 0.06);
  out.about = "Error of the estimate over the run";
  return out;
}

Chart window_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  const ShownReplay replay = shown_replay(sources[0], options);
  Chart out;
  set_time_axis(out, replay, options);
  add_run_marks(out, replay);
  Extent y(true);
  const auto shown = shown_algorithms(replay, options);
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const ReportTrack track = report_track(of_input(shown[k]->map, replay), "window_rms");
    if (track.empty()) continue;
    out.series.push_back(track_series(shown[k]->label, track, 0, replay, true, series_look(k)));
    take_series(y, out.series.back(), out.x);
  }
  if (out.series.empty())
    refuse_kind(sources[0], "window", "no method has an error over time (there is no reference)");
  if (above_zero(replay.optimum)) {
    y.take(replay.optimum);
    FigureSeries optimum;
    optimum.name = "optimum of this scene";
    optimum.x = {out.x.low, out.x.high};
    optimum.y = {replay.optimum, replay.optimum};
    optimum.look = {.ink = Ink::black, .dash = 2, .width = 0.7};
    out.series.push_back(std::move(optimum));
  }
  out.y.log = true;
  const double window_s = replay.map.number_or("window_s", kNone);
  set_value_axis(out,
                 std::isfinite(window_s) ? "RMS error in windows of " + duration_text(window_s)
                                         : "RMS error in a window",
                 replay.unit,
                 y,
                 options,
                 1.25);
  out.about = "RMS of the error in a moving window";
  return out;
}

namespace {

/// Which sensors have a line: those asked for, else those of the largest (smallest variances) values.
std::vector<std::size_t> drawn_sensors(const ShownReplay& replay,
                                       const FigureOptions& options,
                                       const std::vector<double>& values,
                                       bool smallest) {
  std::vector<std::size_t> out;
  refuse_unmatched(options.channels, replay.sensors, replay.file);
  for (std::size_t i = 0; i < replay.sensors.size(); ++i)
    if (is_wanted(options.channels, replay.sensors[i])) out.push_back(i);
  if (out.size() <= kMostSensors) return out;
  const auto rank = [&](std::size_t i) {
    const double v = i < values.size() ? std::fabs(values[i]) : kNone;
    return std::isfinite(v) ? (smallest ? -v : v) : -std::numeric_limits<double>::infinity();
  };
  std::stable_sort(
      out.begin(), out.end(), [&](std::size_t a, std::size_t b) { return rank(a) > rank(b); });
  out.resize(kMostSensors);
  std::sort(out.begin(), out.end());
  return out;
}

Chart sensors_over_time(std::span<const FigureSource> sources,
                        const FigureOptions& options,
                        bool variances) {
  const char* kind = variances ? "variances" : "weights";
  const ShownReplay replay = shown_replay(sources[0], options);
  const ShownAlgorithm* tracked = tracked_algorithm(replay, options, kind);
  const Document* held = tracked == nullptr ? nullptr : tracked->map.get(kind);
  if (held == nullptr)
    refuse_kind(sources[0],
                kind,
                options.algorithm.empty() ? "no method has any" : options.algorithm + " has none");
  if (held->kind == Document::Kind::list && !held->list.empty() &&
      held->list[0].kind == Document::Kind::list)
    refuse_kind(sources[0], kind, "of several inputs there is more than one weight a sensor");
  const std::vector<double> last = report_numbers(tracked->map, kind);
  const ReportTrack track =
      report_track(tracked->map, variances ? "variance_track" : "weight_track");
  Chart out;
  set_time_axis(out, replay, options);
  add_run_marks(out, replay);
  Extent y(variances);
  for (const std::size_t i : drawn_sensors(replay, options, last, variances)) {
    if (!track.empty()) {
      out.series.push_back(
          track_series(replay.sensors[i], track, i, replay, variances, series_look(i)));
    } else if (i < last.size()) {
      FigureSeries flat;
      flat.name = replay.sensors[i];
      flat.x = {out.x.low, out.x.high};
      flat.y = {last[i], last[i]};
      flat.look = series_look(i);
      flat.look.marker = FigureMarker::none;
      out.series.push_back(std::move(flat));
    }
    if (!out.series.empty()) take_series(y, out.series.back(), out.x);
  }
  out.y.log = variances;
  if (!variances) y.take(0.0);
  const std::string unit =
      variances && !replay.sensor_unit.empty() ? "(" + replay.sensor_unit + ")²" : "";
  set_value_axis(out,
                 fmt::format("{} of {}", variances ? "Variance" : "Weight", tracked->label),
                 unit,
                 y,
                 options,
                 variances ? 1.4 : 0.05);
  out.about = fmt::format("{} of {} over the run", kind, tracked->label);
  return out;
}

std::string fault_note(const MapReader& fault, const std::string& answer) {
  const std::string kind = fault.text_or("kind", "");
  const double value = fault.number_or("value", kNone);
  const bool valueless = kind == "stuck" || kind == "dropout" || !std::isfinite(value);
  return kind + (valueless ? "" : " " + number_text(value, 3)) +
         (answer.empty() ? "" : ", " + answer);
}

std::string answer_to(const ShownAlgorithm* tracked, std::size_t fault) {
  if (tracked == nullptr || !tracked->map.has("answers")) return "";
  for (const MapReader& answer : tracked->map.maps("answers")) {
    if (answer.count("fault") != fault) continue;
    const auto found = answer.maybe_number("found_after_s");
    if (!found) return "missed";
    return *found == 0 ? "found at once" : "found after " + duration_text(*found);
  }
  return "";
}

}  // namespace

Chart weights_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  return sensors_over_time(sources, options, false);
}

Chart variances_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  return sensors_over_time(sources, options, true);
}

Chart faults_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  const ShownReplay replay = shown_replay(sources[0], options);
  const ShownAlgorithm* tracked = tracked_algorithm(replay, options, "faults");
  Chart out;
  set_time_axis(out, replay, options);
  const std::vector<std::size_t> rows = drawn_sensors(replay, options, {}, false);
  const auto row_of = [&](const std::string& sensor) {
    const auto at = std::find_if(
        rows.begin(), rows.end(), [&](std::size_t i) { return replay.sensors[i] == sensor; });
    return static_cast<std::size_t>(at - rows.begin());
  };
  const auto add = [&](const MapReader& fault, FigureBar bar) {
    bar.row = row_of(fault.text_or("sensor", ""));
    bar.from = std::max(fault.number("from_s"), replay.start_s) / replay.time_unit_s;
    bar.to = std::min(fault.number_or("to_s", replay.end_s), replay.end_s) / replay.time_unit_s;
    if (bar.row < rows.size() && bar.from < bar.to) out.bars.push_back(std::move(bar));
  };
  std::size_t k = 0;
  if (replay.map.has("faults"))
    for (const MapReader& fault : replay.map.maps("faults")) {
      FigureBar bar{.name = "known to the scene",
                    .note = fault_note(fault, answer_to(tracked, k)),
                    .ink = Ink::grey,
                    .broad = true};
      add(fault, std::move(bar));
      ++k;
    }
  if (tracked != nullptr && tracked->map.has("faults"))
    for (const MapReader& found : tracked->map.maps("faults")) {
      const std::string kind = found.text_or("kind", "");
      const bool noise = kind == "noise";
      FigureBar bar{.name = fmt::format("{}, by {}", noise ? "re-weighted" : "out", tracked->label),
                    .note = kind,
                    .ink = Ink::blue,
                    .hollow = noise};
      add(found, std::move(bar));
    }
  if (out.bars.empty())
    refuse_kind(sources[0], "faults", "no fault is known to the scene, and none was found");
  for (const std::size_t i : rows) out.y.rows.push_back(replay.sensors[i]);
  out.y.low = -0.5;
  out.y.high = static_cast<double>(rows.size()) - 0.5;
  out.about = "Faults and findings";
  return out;
}

Chart error_allan_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  const ShownReplay replay = shown_replay(sources[0], options);
  Chart out;
  Extent x(true), y(true);
  const auto shown = shown_algorithms(replay, options);
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const MapReader input = of_input(shown[k]->map, replay);
    if (!input.has("allan")) continue;
    const MapReader curve = input.map("allan");
    FigureSeries series;
    series.name = shown[k]->label;
    series.x = report_numbers(curve, "tau_s");
    series.y = report_numbers(curve, "deviation", series.x.size());
    series.look = series_look(k);
    x.take(series.x);
    y.take(series.y);
    if (!series.x.empty()) out.series.push_back(std::move(series));
  }
  if (out.series.empty())
    refuse_kind(sources[0], "error-allan", "no method has an Allan curve of its error");
  x.pad(1.4);
  y.pad(1.5);
  out.x = {.title = "Averaging time τ [s]", .log = true, .rows = {}};
  out.y = {
      .title = axis_title("Allan deviation of the error", replay.unit), .log = true, .rows = {}};
  set_ends(out.x, x, options.x_range);
  set_ends(out.y, y, options.y_range);
  out.about = "Allan deviation of the error of each method";
  return out;
}

}  // namespace libchar

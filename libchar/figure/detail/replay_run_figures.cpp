// What is drawn over the run of a replay.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/not_known.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/figure/detail/figure_parts.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostSensors = 24;

/// The part of a list of inputs that is about the input that is drawn.
template <class Input>
const Input& of_input(const std::vector<Input>& inputs, const ShownReplay& replay) {
  if (replay.input < inputs.size()) return inputs[replay.input];
  throw input_error("E0982", replay.report->file)
      .says("a list of inputs is too short")
      .hint("was the report edited? write it again");
}

/// The run, or the stretch of it of which every instant was kept and that holds all that is asked for.
const ReplayReport::Stretch& run_shown(const ShownReplay& replay, const FigureOptions& options) {
  const ReplayReport::Stretch& run = *replay.report->run;
  if (options.x_range)
    for (const ReplayReport::Stretch& close : run.close_ups)
      if (close.from_s <= options.x_range->low * replay.time_unit_s &&
          close.to_s >= options.x_range->high * replay.time_unit_s)
        return close;
  return run;
}

/// A signal that swings through most of its range within each stretch of the whole run would be a filled rectangle.
bool hides_itself(const Timeline& track) {
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
  const ReplayReport::Stretch& run = *replay.report->run;
  if (options.x_range || !hides_itself(of_input(run.inputs, replay).estimate)) return options;
  double fault_s = kNone;
  for (const ReplayReport::Fault& fault : replay.report->faults) fault_s = std::fmin(fault_s, fault.from_s);
  for (const bool any : {false, true})
    for (const ReplayReport::Stretch& close : run.close_ups) {
      const double from = close.from_s, to = close.to_s;
      if (!(from < to) || (!any && !(from <= fault_s && fault_s <= to))) continue;
      options.x_range = Interval{from / replay.time_unit_s, to / replay.time_unit_s};
      return options;
    }
  return options;
}

std::string method_of(const ShownReplay& replay) {
  const std::string& method = replay.report->run->method;
  return method.empty() ? "estimate" : method;
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
  if (!replay.report->run) throw kind_refusal(source, kind).says("nothing was estimated over its run");
}

const FigureLook kReferenceLook{.ink = Ink::black, .dash = 0, .width = 1.3};
const FigureLook kEstimateLook{.ink = Ink::vermilion, .dash = 0, .width = 0.6};
const FigureLook kSensorLook{.ink = Ink::sky, .dash = 0, .width = 0.5};

/// A signal as all its samples would look.
FigureSeries signal_series(const std::string& name, const Timeline& track, const ShownReplay& replay,
                           const FigureLook& look) {
  FigureSeries out;
  out.name = name;
  out.look = look;
  if (track.low.empty()) return out;
  for (std::size_t i = 0; i < track.time_s.size(); ++i)
    add_extremes(out, track.time_s[i] / replay.time_unit_s, track.low[0][i], track.high[0][i]);
  return out;
}

void add_best_sensor(Chart& figure, const Timeline& track, const ShownReplay& replay) {
  if (!track.empty())
    figure.series.push_back(
        signal_series("best sensor " + replay.report->run->sensor_name, track, replay, kSensorLook));
}

std::string name_of_input(const ShownReplay& replay) {
  const std::string& name = replay.report->inputs[replay.input].name;
  return name.empty() ? "value" : name;
}

void set_value_axis(Chart& figure, const std::string& words, const std::string& unit, Extent y,
                    const FigureOptions& options, double pad) {
  y.pad(pad);
  figure.y.title = axis_title(words, unit);
  set_ends(figure.y, y, options.y_range);
}

Chart chart_over_time(const ShownReplay& replay, const FigureOptions& options) {
  Chart out;
  set_time_axis(out, replay, options);
  add_run_marks(out, replay);
  return out;
}

/// The method's signal over those that are there, on an axis that holds what of all of them is shown.
void add_estimate(Chart& figure, const Timeline& track, const std::string& words, const ShownReplay& replay,
                  const FigureOptions& options) {
  figure.series.push_back(signal_series(method_of(replay), track, replay, kEstimateLook));
  Extent y(false);
  for (const FigureSeries& series : figure.series) take_series(y, series, figure.x);
  set_value_axis(figure, words, replay.unit, y, options, 0.06);
}

}  // namespace

Chart timeline_figure(std::span<const FigureSource> sources, const FigureOptions& asked) {
  const ShownReplay replay = shown_replay(sources[0], asked);
  refuse_without_run(sources[0], replay, "timeline");
  const FigureOptions options = with_readable_stretch(replay, asked);
  const ReplayReport::Stretch& run = run_shown(replay, options);
  const InputTracks& input = of_input(run.inputs, replay);
  Chart out = chart_over_time(replay, options);
  if (!input.reference.empty())
    out.series.push_back(signal_series("reference", input.reference, replay, kReferenceLook));
  add_best_sensor(out, run.sensor, replay);
  add_estimate(out, input.estimate, name_of_input(replay), replay, options);
  out.about = "The run: reference, estimate and best sensor";
  return out;
}

Chart error_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  const ShownReplay replay = shown_replay(sources[0], options);
  refuse_without_run(sources[0], replay, "error");
  const ReplayReport::Stretch& run = run_shown(replay, options);
  const Timeline& error = of_input(run.inputs, replay).error;
  if (error.empty()) throw kind_refusal(sources[0], "error").says("without a reference there is no error over the run");
  Chart out = chart_over_time(replay, options);
  add_best_sensor(out, run.sensor_error, replay);
  add_estimate(out, error, "Estimate − reference", replay, options);
  out.about = "Error of the estimate over the run";
  return out;
}

Chart window_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  const ShownReplay replay = shown_replay(sources[0], options);
  Chart out = chart_over_time(replay, options);
  Extent y(true);
  const auto shown = shown_algorithms(replay, options);
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const Timeline& track = of_input(shown[k]->inputs, replay).window_rms;
    if (track.empty()) continue;
    out.series.push_back(track_series(shown[k]->label, track, 0, replay, true, series_look(k)));
    take_series(y, out.series.back(), out.x);
  }
  if (out.series.empty())
    throw kind_refusal(sources[0], "window").says("no method has an error over time (there is no reference)");
  if (above_zero(replay.optimum)) {
    y.take(replay.optimum);
    out.series.push_back(line_series("optimum of this scene", {out.x.low, out.x.high}, {replay.optimum, replay.optimum},
                                     {.ink = Ink::black, .dash = 2, .width = 0.7}));
  }
  out.y.log = true;
  const double window_s = replay.report->window_s;
  set_value_axis(
      out, std::isfinite(window_s) ? "RMS error in windows of " + duration_text(window_s) : "RMS error in a window",
      replay.unit, y, options, 1.25);
  out.about = "RMS of the error in a moving window";
  return out;
}

namespace {

/// Which sensors have a line: those asked for, else those of the largest (smallest variances) values.
std::vector<std::size_t> drawn_sensors(const ShownReplay& replay, const FigureOptions& options,
                                       const std::vector<double>& values, bool smallest) {
  std::vector<std::size_t> out;
  refuse_unmatched(options.channels, replay.sensors, replay.report->file);
  for (std::size_t i = 0; i < replay.sensors.size(); ++i)
    if (is_wanted(options.channels, replay.sensors[i])) out.push_back(i);
  if (out.size() <= kMostSensors) return out;
  const auto rank = [&](std::size_t i) {
    const double v = i < values.size() ? std::fabs(values[i]) : kNone;
    return std::isfinite(v) ? (smallest ? -v : v) : -std::numeric_limits<double>::infinity();
  };
  std::stable_sort(out.begin(), out.end(), [&](std::size_t a, std::size_t b) { return rank(a) > rank(b); });
  out.resize(kMostSensors);
  std::sort(out.begin(), out.end());
  return out;
}

bool has_weights(const ReplayReport::Algorithm& algorithm) { return !algorithm.weights.empty(); }
bool has_variances(const ReplayReport::Algorithm& algorithm) { return !algorithm.variances.empty(); }

Chart sensors_over_time(std::span<const FigureSource> sources, const FigureOptions& options, bool variances) {
  const char* kind = variances ? "variances" : "weights";
  const ShownReplay replay = shown_replay(sources[0], options);
  const ReplayReport::Algorithm* tracked = tracked_algorithm(replay, options, variances ? has_variances : has_weights);
  if (tracked == nullptr || !(variances ? has_variances(*tracked) : has_weights(*tracked)))
    throw kind_refusal(sources[0], kind)
        .says(options.algorithm.empty() ? "no method has any" : options.algorithm + " has none");
  if (!variances && tracked->weights.size() > 1)
    throw kind_refusal(sources[0], kind).says("of several inputs there is more than one weight per sensor");
  const std::vector<double>& last = variances ? tracked->variances : tracked->weights[0];
  const Timeline& track = variances ? tracked->variance_track : tracked->weight_track;
  Chart out = chart_over_time(replay, options);
  Extent y(variances);
  for (const std::size_t i : drawn_sensors(replay, options, last, variances)) {
    if (!track.empty()) {
      out.series.push_back(track_series(replay.sensors[i], track, i, replay, variances, series_look(i)));
    } else if (i < last.size()) {
      out.series.push_back(line_series(replay.sensors[i], {out.x.low, out.x.high}, {last[i], last[i]}, series_look(i)));
      out.series.back().look.marker = FigureMarker::none;
    }
    if (!out.series.empty()) take_series(y, out.series.back(), out.x);
  }
  out.y.log = variances;
  if (!variances) y.take(0.0);
  const std::string unit = variances && !replay.sensor_unit.empty() ? "(" + replay.sensor_unit + ")²" : "";
  set_value_axis(out, fmt::format("{} of {}", variances ? "Variance" : "Weight", tracked->label), unit, y, options,
                 variances ? 1.4 : 0.05);
  out.about = fmt::format("{} of {} over the run", kind, tracked->label);
  return out;
}

std::string fault_note(const ReplayReport::Fault& fault, const std::string& answer) {
  const bool valueless = fault.kind == "stuck" || fault.kind == "dropout" || !std::isfinite(fault.value);
  return fault.kind + (valueless ? "" : " " + number_text(fault.value, 3)) + (answer.empty() ? "" : ", " + answer);
}

std::string answer_to(const ReplayReport::Algorithm* tracked, std::size_t fault) {
  if (tracked == nullptr) return "";
  for (const FaultAnswer& answer : tracked->answers) {
    if (answer.fault != fault) continue;
    if (!answer.found_s) return "missed";
    return *answer.found_s == 0 ? "found at once" : "found after " + duration_text(*answer.found_s);
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
  const ReplayReport::Algorithm* tracked =
      tracked_algorithm(replay, options, [](const auto& a) { return a.watches_faults; });
  Chart out;
  set_time_axis(out, replay, options);
  const std::vector<std::size_t> rows = drawn_sensors(replay, options, {}, false);
  const auto row_of = [&](const std::string& sensor) {
    const auto at = std::find_if(rows.begin(), rows.end(), [&](std::size_t i) { return replay.sensors[i] == sensor; });
    return static_cast<std::size_t>(at - rows.begin());
  };
  const auto add = [&](const ReplayReport::Fault& fault, FigureBar bar) {
    bar.row = row_of(fault.sensor);
    bar.from = std::max(fault.from_s, replay.report->start_s) / replay.time_unit_s;
    bar.to = std::min(fault.to_s, replay.end_s) / replay.time_unit_s;
    if (bar.row < rows.size() && bar.from < bar.to) out.bars.push_back(std::move(bar));
  };
  const std::vector<ReplayReport::Fault>& known = replay.report->faults;
  for (std::size_t k = 0; k < known.size(); ++k)
    add(known[k], {.name = "known to the scene",
                   .note = fault_note(known[k], answer_to(tracked, k)),
                   .ink = Ink::grey,
                   .broad = true});
  for (const ReplayReport::Fault& found : tracked != nullptr ? tracked->found : std::vector<ReplayReport::Fault>{}) {
    const bool noise = found.kind == "noise";
    add(found, {.name = fmt::format("{}, by {}", noise ? "re-weighted" : "out", tracked->label),
                .note = found.kind,
                .ink = Ink::blue,
                .hollow = noise});
  }
  if (out.bars.empty())
    throw kind_refusal(sources[0], "faults").says("no fault is known to the scene, and none was found");
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
    FigureSeries series;
    series.name = shown[k]->label;
    for (const AllanPoint& point : of_input(shown[k]->inputs, replay).allan.points) {
      series.x.push_back(point.tau_s);
      series.y.push_back(point.deviation);
    }
    series.look = series_look(k);
    x.take(series.x);
    y.take(series.y);
    if (!series.x.empty()) out.series.push_back(std::move(series));
  }
  if (out.series.empty())
    throw kind_refusal(sources[0], "error-allan").says("no method has an Allan curve of its error");
  x.pad(1.4);
  y.pad(1.5);
  out.x = {.title = "Averaging time τ [s]", .log = true, .rows = {}};
  out.y = {.title = axis_title("Allan deviation of the error", replay.unit), .log = true, .rows = {}};
  set_ends(out.x, x, options.x_range);
  set_ends(out.y, y, options.y_range);
  out.about = "Allan deviation of the error of each method";
  return out;
}

}  // namespace libchar


#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "libchar/core/not_known.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/figure/detail/figure_parts.hpp"

namespace libchar {
namespace {

std::vector<std::string> labels_of(const ShownReplay& replay) {
  std::vector<std::string> out;
  for (const ReplayReport::Algorithm* one : replay.ranked) out.push_back(one->label);
  return out;
}

std::size_t input_asked_for(const ReplayReport& report, const FigureOptions& options) {
  if (options.input.empty()) return 0;
  std::vector<std::string> names;
  for (const InputResult& input : report.inputs) names.push_back(input.name);
  refuse_unmatched({options.input}, names, report.file);
  const auto found =
      std::find_if(names.begin(), names.end(), [&](const std::string& name) { return matches(options.input, name); });
  return static_cast<std::size_t>(found - names.begin());
}

}  // namespace

const ReplayReport::Algorithm* ShownReplay::find(const std::string& label) const {
  for (const ReplayReport::Algorithm* one : ranked)
    if (one->label == label) return one;
  return nullptr;
}

ShownReplay shown_replay(const FigureSource& source, const FigureOptions& options) {
  const ReplayReport& report = *source.replay;
  ShownReplay out;
  out.report = &report;
  if (report.inputs.empty()) throw input_error("E0982", report.file).says("the list of inputs is empty");
  out.input = input_asked_for(report, options);
  out.unit = usual_figure_unit(report.inputs[out.input].unit);
  out.optimum = report.reference ? report.inputs[out.input].optimum_rmse : kNone;
  for (const SensorResult& sensor : report.sensors) out.sensors.push_back(sensor.name);
  if (!report.sensors.empty()) out.sensor_unit = usual_figure_unit(report.sensors[0].unit);
  out.end_s = report.end_s();
  std::tie(out.time_unit_s, out.time_unit) = time_unit_for(out.end_s);
  for (const std::string& label : report.ranked)
    if (const ReplayReport::Algorithm* one = report.find(label); one != nullptr && one->ran) out.ranked.push_back(one);
  return out;
}

void set_time_axis(Chart& figure, const ShownReplay& replay, const FigureOptions& options) {
  Extent x(false);
  x.take(replay.report->start_s / replay.time_unit_s);
  x.take(replay.end_s / replay.time_unit_s);
  figure.x = {.title = fmt::format("Time [{}]", replay.time_unit), .rows = {}};
  set_ends(figure.x, x, options.x_range);
}

void add_run_marks(Chart& figure, const ShownReplay& replay) {
  for (const RunMark& mark : replay.report->marks) {
    const bool fault = mark.kind == "fault";
    figure.stretches.push_back({mark.from_s / replay.time_unit_s, mark.to_s / replay.time_unit_s,
                                fault ? "faults" : mark.label, fault ? Ink::orange : Ink::grey});
  }
}

FigureSeries track_series(const std::string& name, const Timeline& track, std::size_t series, const ShownReplay& replay,
                          bool log, FigureLook look) {
  FigureSeries out;
  out.name = name;
  out.look = look;
  out.look.marker = FigureMarker::none;
  if (series >= track.low.size()) return out;
  for (std::size_t i = 0; i < track.time_s.size(); ++i) {
    const double low = track.low[series][i], high = track.high[series][i];
    out.x.push_back(track.time_s[i] / replay.time_unit_s);
    out.low.push_back(low);
    out.high.push_back(high);
    out.y.push_back(log ? (low > 0 ? std::sqrt(low * high) : kNone) : (low + high) / 2);
  }
  if (out.low == out.high) {
    out.low.clear();
    out.high.clear();
  }
  return out;
}

void refuse_unmatched_methods(const ShownReplay& replay, const FigureOptions& options) {
  refuse_unmatched(options.channels, labels_of(replay), replay.report->file);
}

std::vector<const ReplayReport::Algorithm*> shown_algorithms(const ShownReplay& replay, const FigureOptions& options) {
  std::vector<const ReplayReport::Algorithm*> out;
  if (!options.channels.empty()) {
    refuse_unmatched_methods(replay, options);
    for (const ReplayReport::Algorithm* one : replay.ranked)
      if (is_wanted(options.channels, one->label)) out.push_back(one);
    return out;
  }
  const auto add = [&](const ReplayReport::Algorithm* one) {
    if (one != nullptr && std::find(out.begin(), out.end(), one) == out.end()) out.push_back(one);
  };
  add(replay.find(replay.report->best));
  for (const ReplayReport::Algorithm* one : replay.ranked)
    if (!one->bound && !one->learns) {
      add(one);
      break;
    }
  add(replay.find("mean"));
  for (const ReplayReport::Algorithm* one : replay.ranked)
    if (one->bound) add(one);
  for (const ReplayReport::Algorithm* one : replay.ranked)
    if (out.size() < 3) add(one);
  return out;
}

const ReplayReport::Algorithm* tracked_algorithm(const ShownReplay& replay, const FigureOptions& options,
                                                 bool (*has)(const ReplayReport::Algorithm& algorithm)) {
  if (!options.algorithm.empty()) {
    if (const ReplayReport::Algorithm* one = replay.find(options.algorithm)) return one;
    const std::vector<std::string> labels = labels_of(replay);
    throw usage_error("E0977", replay.report->file)
        .says("no algorithm of this label ran")
        .got(options.algorithm)
        .hint(did_you_mean(nearest(options.algorithm, labels), "there are " + first_names(labels)));
  }
  const ReplayReport::Algorithm* const best = replay.find(replay.report->best);
  if (best != nullptr && has(*best)) return best;
  for (const ReplayReport::Algorithm* one : replay.ranked)
    if (has(*one) && !one->bound) return one;
  return nullptr;
}

}  // namespace libchar

#include "libchar/figure/detail/sources/replay_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/figure/detail/figure_parts.hpp"

namespace libchar {
namespace {

constexpr double kHour = 3600, kDay = 86400;

double score_of(const MapReader& algorithm, bool rmse) {
  if (rmse) return algorithm.number_or("rmse", kNone);
  if (!algorithm.has("without_reference")) return kNone;
  return algorithm.map("without_reference").number_or("predictive_rms", kNone);
}

void read_algorithms(ShownReplay& out, bool rmse) {
  std::vector<ShownAlgorithm> ran;
  for (MapReader& map : out.map.maps("algorithms")) {
    if (map.text_or("status", "") != "ran") continue;
    ShownAlgorithm one{map, map.text("label")};
    one.score = score_of(map, rmse);
    one.bound = map.flag_or("bound", false);
    if (map.has("description"))
      one.learns = map.map("description").flag_or("learns_from_reference", false);
    ran.push_back(std::move(one));
  }
  const std::vector<std::string> order =
      out.map.has("ranked") ? out.map.texts("ranked") : std::vector<std::string>{};
  for (const std::string& label : order)
    for (ShownAlgorithm& one : ran)
      if (one.label == label) out.ranked.push_back(one);
}

std::size_t input_asked_for(const std::vector<MapReader>& inputs,
                            const FigureOptions& options,
                            const std::string& file) {
  if (options.input.empty()) return 0;
  std::vector<std::string> names;
  names.reserve(inputs.size());
  for (const MapReader& input : inputs) names.push_back(input.text_or("name", ""));
  refuse_unmatched({options.input}, names, file);
  return static_cast<std::size_t>(
      std::find_if(names.begin(),
                   names.end(),
                   [&](const std::string& name) { return matches(options.input, name); }) -
      names.begin());
}

}  // namespace

const ShownAlgorithm* ShownReplay::find(const std::string& label) const {
  for (const ShownAlgorithm& one : ranked)
    if (one.label == label) return &one;
  return nullptr;
}

ShownReplay shown_replay(const FigureSource& source, const FigureOptions& options) {
  ShownReplay out{{*source.replay, source.file, ""}, source.file};
  const bool rmse = out.map.text_or("score", "rmse") == "rmse";
  out.score_name = rmse ? "RMSE" : "Leave-one-out RMS";
  out.has_reference = out.map.has("reference");
  out.best = out.map.text_or("best", "");
  const std::vector<MapReader> inputs = out.map.maps("inputs");
  if (inputs.empty()) out.map.refuse("inputs", "the list is empty");
  out.input = input_asked_for(inputs, options, source.file);
  out.input_name = inputs[out.input].text_or("name", "value");
  out.unit = usual_figure_unit(inputs[out.input].text_or("unit", ""));
  out.optimum = rmse ? inputs[out.input].number_or("optimum_rmse", kNone) : kNone;
  for (const MapReader& sensor : out.map.maps("sensors")) {
    if (out.sensors.empty()) out.sensor_unit = usual_figure_unit(sensor.text_or("unit", ""));
    out.sensors.push_back(sensor.text("name"));
  }
  out.start_s = out.map.number_or("start_s", 0);
  out.end_s =
      out.start_s + out.map.number("instants", kPositive) / out.map.number("rate_hz", kPositive);
  if (out.end_s > 4e5) {
    out.time_unit_s = kDay;
    out.time_unit = "d";
  } else if (out.end_s > 2e4) {
    out.time_unit_s = kHour;
    out.time_unit = "h";
  }
  read_algorithms(out, rmse);
  return out;
}

void set_time_axis(Chart& figure, const ShownReplay& replay, const FigureOptions& options) {
  Extent x(false);
  x.take(replay.start_s / replay.time_unit_s);
  x.take(replay.end_s / replay.time_unit_s);
  figure.x = {.title = fmt::format("Time [{}]", replay.time_unit), .rows = {}};
  set_ends(figure.x, x, options.x_range);
}

void add_run_marks(Chart& figure, const ShownReplay& replay) {
  if (!replay.map.has("marks")) return;
  for (const MapReader& mark : replay.map.maps("marks")) {
    const bool fault = mark.text_or("kind", "") == "fault";
    figure.stretches.push_back({mark.number("from_s") / replay.time_unit_s,
                                mark.number("to_s") / replay.time_unit_s,
                                fault ? "faults" : mark.text_or("label", ""),
                                fault ? Ink::orange : Ink::grey});
  }
}

FigureSeries track_series(const std::string& name,
                          const ReportTrack& track,
                          std::size_t series,
                          const ShownReplay& replay,
                          bool log,
                          FigureLook look) {
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

std::vector<const ShownAlgorithm*> shown_algorithms(const ShownReplay& replay,
                                                    const FigureOptions& options) {
  std::vector<std::string> labels;
  for (const ShownAlgorithm& one : replay.ranked) labels.push_back(one.label);
  std::vector<const ShownAlgorithm*> out;
  if (!options.channels.empty()) {
    refuse_unmatched(options.channels, labels, replay.file);
    for (const ShownAlgorithm& one : replay.ranked)
      if (is_wanted(options.channels, one.label)) out.push_back(&one);
    return out;
  }
  const auto add = [&](const ShownAlgorithm* one) {
    if (one != nullptr && std::find(out.begin(), out.end(), one) == out.end()) out.push_back(one);
  };
  add(replay.find(replay.best));
  for (const ShownAlgorithm& one : replay.ranked)
    if (!one.bound && !one.learns) {
      add(&one);
      break;
    }
  add(replay.find("mean"));
  for (const ShownAlgorithm& one : replay.ranked)
    if (one.bound) add(&one);
  for (const ShownAlgorithm& one : replay.ranked)
    if (out.size() < 3) add(&one);
  return out;
}

const ShownAlgorithm* tracked_algorithm(const ShownReplay& replay,
                                        const FigureOptions& options,
                                        const std::string& key) {
  if (!options.algorithm.empty()) {
    if (const ShownAlgorithm* one = replay.find(options.algorithm)) return one;
    std::vector<std::string> labels;
    for (const ShownAlgorithm& one : replay.ranked) labels.push_back(one.label);
    throw Error(
        {ErrorKind::usage,
         "E0977",
         replay.file,
         "no algorithm of this label ran",
         options.algorithm,
         did_you_mean(nearest(options.algorithm, labels), "there are " + first_names(labels))});
  }
  const auto has = [&](const ShownAlgorithm& one) {
    return key == "faults" ? one.map.flag_or("watches_faults", false) : one.map.has(key);
  };
  if (const ShownAlgorithm* best = replay.find(replay.best); best != nullptr && has(*best))
    return best;
  for (const ShownAlgorithm& one : replay.ranked)
    if (has(one) && !one.bound) return &one;
  return nullptr;
}

}  // namespace libchar

#include "libchar/replay/report/replay_report.hpp"

#include <fmt/format.h>

#include <set>

#include "libchar/characterize/compare/reported_characterization.hpp"
#include "libchar/core/document/document.hpp"
#include "libchar/core/refusal.hpp"

namespace libchar {
namespace {

// "characterization" is a report too; which verb reads it is the hint.
void check_report(const Document& document, const std::string& file) {
  const DocumentEntry* format = document.find("format");
  if (document.kind == Document::Kind::map && format != nullptr && format->value.kind == Document::Kind::text &&
      format->value.text != "replay-report")
    throw input_error("E0920", format->value.line > 0
                                   ? fmt::format("{}:{}:{}", file, format->value.line, format->value.column)
                                   : file)
        .says("compare reads reports of a replay (format replay-report), this is another one")
        .got(format->value.text)
        .hint("the report.json of a replay is one");
  check_format(document, file, "replay-report", 1);
}

void check_window(const MapReader& top, std::string_view key, const TimeWindow& window) {
  if (!(window.from_s < window.to_s)) top.map(key).refuse("to_s", "a window goes from a time to a later one");
}

// As long as the list of times; smallest and largest are the same where only one of them is written.
void complete(const MapReader& at, Timeline& track, const std::vector<double>& time_s) {
  if (track.low.empty()) return;
  if (track.time_s.empty()) track.time_s = time_s;
  if (track.high.empty()) track.high = track.low;
  bool right = track.high.size() == track.low.size();
  for (const auto* side : {&track.low, &track.high})
    for (const std::vector<double>& series : *side) right = right && series.size() == track.time_s.size();
  if (!right)
    throw input_error("E0982", at.where(at.node()))
        .says("a track has not one value for each of its times")
        .hint("was the report edited? write it again");
}

void complete(const MapReader& at, ReplayReport::Stretch& stretch) {
  for (InputTracks& input : stretch.inputs)
    for (Timeline* track : {&input.reference, &input.estimate, &input.error}) complete(at, *track, stretch.time_s);
  for (Timeline* track : {&stretch.sensor, &stretch.sensor_error, &stretch.deviations})
    complete(at, *track, stretch.time_s);
  for (ReplayReport::Stretch& close_up : stretch.close_ups) complete(at, close_up);
}

void complete(const MapReader& at, ReplayReport::Algorithm& algorithm) {
  if (algorithm.label.empty()) algorithm.label = algorithm.name;
  if (algorithm.blind) {
    algorithm.rmse = algorithm.blind->predictive_rms;
    algorithm.rmse_ci95 = algorithm.blind->predictive_ci95;
  }
  for (Timeline* track : {&algorithm.weight_track, &algorithm.variance_track}) complete(at, *track, {});
  for (InputScore& input : algorithm.inputs) complete(at, input.window_rms, {});
}

}  // namespace

ReplayReport::Algorithm::Algorithm() {
  rmse = regret = ns_per_sample = learning_s = availability = kNone;
  rmse_ci95 = {kNone, kNone};
}

const ReplayReport::Algorithm* ReplayReport::find(std::string_view label) const {
  for (const ReplayReport::Algorithm& a : algorithms)
    if (a.label == label) return &a;
  return nullptr;
}

ReplayReport parse_replay_report(const Document& document, const std::string& file) {
  check_report(document, file);
  const MapReader top(document, file, "");
  ReplayReport out;
  out.file = file;
  read_fields(document_head_fields(), top, out.head);
  read_fields(ReplayReport::fields(), top, out);
  check_window(top, "evaluation", out.evaluation);
  if (out.learning) check_window(top, "learning", *out.learning);
  if (out.run) complete(top.map("run"), *out.run);
  const std::vector<MapReader> algorithms = top.maps("algorithms");
  std::set<std::string> labels;
  for (std::size_t i = 0; i < algorithms.size(); ++i) {
    complete(algorithms[i], out.algorithms[i]);
    if (!labels.insert(out.algorithms[i].label).second) algorithms[i].refuse("label", "is repeated in this report");
  }
  return out;
}

ReplayReport parse_replay_report(std::string_view text, const std::string& path) {
  return parse_replay_report(parse_json_document(text, path), path);
}

ReplayReport read_replay_report(const std::string& path) {
  const std::string file = report_file(path);
  return parse_replay_report(read_document_text(file), file);
}

}  // namespace libchar

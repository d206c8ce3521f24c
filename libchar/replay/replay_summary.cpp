#include "libchar/replay/replay_summary.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <set>

#include "libchar/core/document/document_file.hpp"
#include "libchar/core/document/json_reader.hpp"
#include "libchar/core/document/schema.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/model/model_reader.hpp"

namespace libchar {
namespace {

// A number that may be null, but whose key must be there.
double number_or_none(const MapReader& map,
                      const std::string& key,
                      NumberRange range = kAnyNumber) {
  if (map.node().find(key) == nullptr) map.require(key);
  return map.number_or(key, kNone, range);
}

Interval interval_or_none(const MapReader& map, const std::string& key) {
  if (map.node().find(key) == nullptr) map.require(key);
  if (!map.has(key)) return {kNone, kNone};
  const auto [low, high] = map.interval(key);
  return {low, high};
}

bool flag(const MapReader& map, const std::string& key) {
  map.require(key);
  return map.flag_or(key, false);
}

TimeWindow window(const MapReader& map) {
  TimeWindow out{map.number("from_s"),
                 map.number_or("to_s", std::numeric_limits<double>::infinity())};
  if (!(out.from_s < out.to_s)) map.refuse("to_s", "a window goes from a time to a later one");
  return out;
}

void read_scene(const MapReader& map, ReplaySummary& out) {
  out.scene_name = map.text_or("name", "");
  out.scene_file = map.text_or("file", "");
  out.simulated = flag(map, "simulated");
  if (!out.simulated) return;
  out.seed = map.count("seed");
  out.identity = map.text("identity");
}

void read_reference(const MapReader& map, ReplaySummary& out) {
  if (map.node().find("reference") == nullptr) map.require("reference");
  out.has_reference = map.has("reference");
  if (!out.has_reference) return;
  const MapReader reference = map.map("reference");
  out.reference_use = reference.text("use");
  out.lag_s = number_or_none(reference, "lag_s");
  out.lag_estimated = flag(reference, "lag_estimated");
}

SensorSummary sensor(const MapReader& map) {
  return {map.text("name"),
          map.text_or("unit", ""),
          number_or_none(map, "rmse", kNotNegative),
          map.numbers("h"),
          map.maybe_number("noise_variance", kNotNegative)};
}

AlgorithmSummary algorithm(const MapReader& map) {
  AlgorithmSummary out;
  out.name = map.text("name");
  out.label = map.text_or("label", out.name);
  out.ran = map.word("status", {"ran", "skipped"}) == "ran";
  out.why = map.text_or("why", "");
  out.bound = map.flag_or("bound", false);
  out.rmse = number_or_none(map, "rmse", kNotNegative);
  out.rmse_ci95 = interval_or_none(map, "rmse_ci95");
  if (map.has("without_reference")) {
    const MapReader blind = map.map("without_reference");
    // Reports of earlier versions are ranked by the root of the mean over the sensors.
    const bool geometric = blind.has("predictive_rms");
    out.rmse =
        number_or_none(blind, geometric ? "predictive_rms" : "leave_one_out_rms", kNotNegative);
    out.rmse_ci95 = interval_or_none(blind, geometric ? "predictive_ci95" : "leave_one_out_ci95");
  }
  out.regret = number_or_none(map, "regret");
  out.ns_per_sample = map.number_or("ns_per_sample", kNone, kNotNegative);
  out.peak_bytes = map.number_or("peak_bytes", kNone, kNotNegative);
  if (map.has("options")) {
    const MapReader options = map.map("options");
    for (const DocumentEntry& entry : options.node().map)
      out.options.emplace_back(entry.key, options.number_or(entry.key, kNone));
  }
  return out;
}

// "characterization" is a report too; which verb reads it is the hint.
void check_report(const Document& document, const std::string& file) {
  const DocumentEntry* format = document.find("format");
  if (document.kind == Document::Kind::map && format != nullptr &&
      format->value.kind == Document::Kind::text && format->value.text != "replay-report")
    throw Error({ErrorKind::input,
                 "E0920",
                 format->value.line > 0
                     ? fmt::format("{}:{}:{}", file, format->value.line, format->value.column)
                     : file,
                 "compare reads reports of a replay (format replay-report), this is another one",
                 format->value.text,
                 "the report.json of a replay is one"});
  check_format(document, file, "replay-report", 1);
}

ReplaySummary read(const Document& document, const std::string& file) {
  check_report(document, file);
  const MapReader map(document, file, "");
  ReplaySummary out;
  out.file = file;
  if (map.has("tool")) out.program = map.map("tool").text_or("version", "");
  read_scene(map.map("scene"), out);
  for (const MapReader& one : map.maps("input"))
    out.files.push_back({one.text("path"), one.text_or("sha256", "")});
  out.rate_hz = map.number("rate_hz", kPositive);
  out.instants = map.count("instants");
  if (map.has("learning")) out.learning = window(map.map("learning"));
  out.evaluation = window(map.map("evaluation"));
  read_reference(map, out);
  for (const MapReader& one : map.maps("inputs"))
    out.inputs.push_back({one.text("name"), one.text_or("unit", "")});
  for (const MapReader& one : map.maps("sensors")) out.sensors.push_back(sensor(one));
  for (const MapReader& one : map.maps("faults"))
    out.faults.push_back({one.text("sensor"),
                          one.text("kind"),
                          one.number_or("value", kNone),
                          one.number_or("from_s", kNone),
                          one.number_or("to_s", kNone)});
  out.best = map.text_or("best", "");
  std::set<std::string> labels;
  for (const MapReader& one : map.maps("algorithms")) {
    out.algorithms.push_back(algorithm(one));
    if (!labels.insert(out.algorithms.back().label).second)
      one.refuse("label", "stands twice in this report");
  }
  return out;
}

}  // namespace

const AlgorithmSummary* ReplaySummary::find(std::string_view label) const {
  for (const AlgorithmSummary& a : algorithms)
    if (a.label == label) return &a;
  return nullptr;
}

ReplaySummary parse_replay_report(std::string_view text, const std::string& path) {
  return read(parse_json_document(text, path), path);
}

ReplaySummary read_replay_report(const std::string& path) {
  std::error_code ignored;
  const std::string file = std::filesystem::is_directory(path, ignored)
                               ? (std::filesystem::path(path) / "report.json").string()
                               : path;
  return parse_replay_report(read_document_text(file), file);
}

}  // namespace libchar

#include "libchar/characterize/compare/reported_characterization.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libchar/characterize/curves/curve_document.hpp"
#include "libchar/characterize/curves/model_curve.hpp"
#include "libchar/core/document/coefficient_fields.hpp"
#include "libchar/core/document/document.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/fit/curve/curve_table.hpp"
#include "libchar/fit/fit_json.hpp"
#include "libchar/model/model_file.hpp"

namespace libchar {
namespace {

constexpr std::string_view kFormats[] = {"characterization", "pooled-runs", "noise-fit"};

std::string format_of(const Document& document) {
  const DocumentEntry* const format = document.kind == Document::Kind::map ? document.find("format") : nullptr;
  return format != nullptr && format->value.kind == Document::Kind::text ? format->value.text : "";
}

bool is_known(const std::string& format) {
  return std::find(std::begin(kFormats), std::end(kFormats), format) != std::end(kFormats);
}

void check_interval(const MapReader& term, const Coefficient& c) {
  if (c.value && !(c.ci95.low <= *c.value && *c.value <= c.ci95.high))
    term.refuse("ci95", "the interval does not hold the value");
}

ReportedChannel read_channel(const MapReader& map) {
  ReportedChannel out;
  out.name = map.text("name");
  out.unit = map.text_or("unit", "");
  out.fitted = map.has("goodness");
  if (!out.fitted) return out;
  NoiseFit fit;
  fit.band.top_hz = fit.goodness.p = kNone;
  read_fields(noise_fit_fields(), map, fit);
  for (std::size_t t = 0; t < kTerms; ++t) check_interval(map.map(kTermNames[t].key), fit.term[t]);
  out.term = fit.term;
  out.p = fit.goodness.p;
  out.rate_hz = fit.rate_hz;
  out.duration_s = fit.duration_s;
  out.band = fit.band;
  out.shape = name_of(fit.shape.kind);
  if (fit.shape.taps > 0) out.shape += fmt::format(" of {}", fit.shape.taps);
  out.events = fit.events.size();
  return out;
}

std::string recording_of(const MapReader& map) {
  if (!map.has("input")) return "";
  const std::vector<MapReader> input = map.maps("input");
  if (input.empty()) return "";
  const std::string first = input[0].text_or("path", "");
  return input.size() == 1 ? first : fmt::format("{} and {} more", first, input.size() - 1);
}

/// Intervals of the Allan family hold for its own statistics only: others are not compared with them.
bool is_compared(const std::string& statistic) {
  return statistic.empty() || statistic == "oadev" || statistic == "adev" || statistic == "totdev" ||
         statistic == "oavar" || statistic == "avar";
}

ReportedChannel& channel_of(ReportedCharacterization& out, const std::string& name, const std::string& unit) {
  for (ReportedChannel& c : out.channels)
    if (c.name == name) return c;
  ReportedChannel& made = out.channels.emplace_back();
  made.name = name;
  made.unit = unit;
  return made;
}

void read_curves(const MapReader& allan, ReportedCharacterization& out) {
  const AllanDocument read = read_allan(allan);
  for (const AllanOfChannel& one : read.channels)
    if (is_compared(one.type.empty() ? read.type : one.type) && one.value_unit.empty())
      channel_of(out, one.name, one.unit).curve = one.curve.points;
}

ReportedCharacterization read_summary(const Document& document, const std::string& file) {
  const std::string format = format_of(document);
  if (!is_known(format) && format != "allan")
    throw input_error("E0771", file)
        .says("expected a log, the report of a characterization, a sensor model, or the YAML of Kalibr or imu_utils")
        .got(format)
        .hint("of a file for another program, compare the report or the sensor model that it was exported from");
  check_format(document, file, format, 1);
  ReportedCharacterization out;
  out.file = file;
  out.name = detail::document_name(file);
  out.format = format;
  const MapReader map(document, file, "");
  if (map.has("tool")) out.program = map.map("tool").text_or("version", "");
  out.recording = recording_of(map);
  out.findings = detail::reported_findings(map);
  if (format == "allan") {
    read_curves(map, out);
    return out;
  }
  const MapReader fit = format == "noise-fit" ? map : map.map("fit");
  for (const MapReader& one : fit.maps("channels")) {
    out.channels.push_back(read_channel(one));
    if (out.find(out.channels.back().name) != &out.channels.back())
      fit.refuse("channels", "two channels have one name: " + out.channels.back().name);
  }
  if (map.has("allan")) read_curves(map.map("allan"), out);
  return out;
}

ReportedCharacterization read_curve_candidate(const std::string& file) {
  ReportedCharacterization out;
  out.file = file;
  out.name = detail::document_name(file);
  out.format = "curve";
  const auto table = read_curve_table(file, true);
  for (const NamedCurve& named : table ? table->curves : std::vector<NamedCurve>{}) {
    if (!is_compared(named.kind)) continue;
    ReportedChannel& channel = channel_of(out, named.name, named.unit);
    detail::add_cautions(out.findings, named.findings, named.name);
    for (std::size_t i = 0; i < named.curve.x.size(); ++i) {
      AllanPoint& point = channel.curve.emplace_back();
      point.tau_s = named.curve.x[i];
      point.deviation = named.curve.root ? named.curve.y[i] : std::sqrt(named.curve.y[i]);
      if (i < named.low95.size()) point.ci95 = {named.low95[i], named.high95[i]};
    }
  }
  return out;
}

/// Models as a characterization: their coefficients and the curves that they imply.
ReportedCharacterization reported_models(const std::vector<SensorModel>& models, const std::string& path) {
  ReportedCharacterization out;
  out.file = path;
  out.name = detail::document_name(path);
  out.format = "sensor-model";
  for (const SensorModel& model : models) {
    ReportedChannel& channel = channel_of(out, model.channel, model.unit);
    channel.fitted = true;
    channel.term = model.noise;
    // A value that is stated without an interval is taken as it is.
    for (Coefficient& c : channel.term)
      if (c.value && !(c.ci95.high > 0)) c.ci95 = {*c.value, *c.value};
    channel.p = kNone;
    channel.rate_hz = model.rate_hz;
    channel.duration_s = model.duration_s;
    channel.band.whole = true;
    channel.events = model.deterministic.size();
    channel.shape = name_of(model.noise_shape.kind);
    if (model.noise_shape.taps > 0) channel.shape += fmt::format(" of {}", model.noise_shape.taps);
    channel.curve = sensor_model_curve(model, sensor_model_fit(model)).points;
    if (out.recording.empty()) out.recording = model.recording.file;
    add_cautions(out.findings, model.findings, model.channel);
  }
  return out;
}

}  // namespace

namespace detail {

std::string document_name(const std::string& path) {
  const std::filesystem::path file(path);
  const std::string stem = file.stem().string();
  const std::string folder = file.parent_path().filename().string();
  const bool plain = stem == "report" || stem == "runs" || stem == "curves";
  if (plain && !folder.empty() && folder != "." && folder != "..") return folder;
  return stem.ends_with(".sensor") ? stem.substr(0, stem.size() - 7) : stem;
}

void set_names_apart(std::vector<std::string>& names, const std::vector<std::string>& files) {
  const std::vector<std::string> all = names;
  for (std::size_t i = 0; i < names.size(); ++i) {
    bool alike = false;
    for (std::size_t j = 0; j < all.size(); ++j) alike = alike || (all[j] == all[i] && files[j] != files[i]);
    if (!alike) continue;
    const std::filesystem::path file(files[i]);
    const std::string folder = file.parent_path().filename().string();
    names[i] = folder.empty() || folder == all[i] ? file.string() : folder + "/" + all[i];
  }
}

bool ends_like_a_document(const std::string& path) {
  return path.ends_with(".json") || path.ends_with(".yaml") || path.ends_with(".yml");
}

bool is_recording(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    return std::filesystem::exists(std::filesystem::path(path) / "metadata.yaml", ignored);
  return !ends_like_a_document(path) && curve_in_header(path).empty();
}

std::string document_format(const std::string& path) {
  try {
    const std::string file = report_file(path);
    return format_of(parse_json_document(read_document_text(file), file));
  } catch (const Error&) {
    return "";
  }
}

}  // namespace detail

const ReportedChannel* ReportedCharacterization::find(std::string_view channel) const {
  for (const ReportedChannel& c : channels)
    if (c.name == channel) return &c;
  return nullptr;
}

std::string report_file(const std::string& path) {
  std::error_code ignored;
  const std::filesystem::path folder(path);
  if (!std::filesystem::is_directory(folder, ignored)) return path;
  refuse_interrupted(folder);
  const bool pooled = !std::filesystem::exists(folder / "report.json", ignored) &&
                      std::filesystem::exists(folder / "runs.json", ignored);
  return (folder / (pooled ? "runs.json" : "report.json")).string();
}

void refuse_lot_report(const std::string& path, const std::string& instead) {
  std::error_code ignored;
  std::string file = report_file(path);
  if (!std::filesystem::exists(file, ignored)) file = (std::filesystem::path(path) / "lot.json").string();
  if (detail::document_format(file) == "lot")
    throw input_error("E0771", file).says("this is the report of a lot of devices").got("lot").hint(instead);
}

ReportedCharacterization parse_characterization_report(std::string_view text, const std::string& path) {
  return read_summary(parse_json_document(text, path), path);
}

ReportedCharacterization read_characterization_report(const std::string& path) {
  const std::string file = report_file(path);
  if (!detail::ends_like_a_document(file)) return read_curve_candidate(file);
  const std::string text = read_document_text(file);
  const Document document = parse_document(text, file);
  if (detail::holds_models(document)) return reported_models(read_model_list(file), file);
  return read_summary(document, file);
}

}  // namespace libchar

namespace libchar::detail {

std::vector<Finding> reported_findings(const MapReader& document) {
  std::vector<Finding> out;
  if (document.has("findings"))
    for (const MapReader& row : document.maps("findings")) {
      Finding one;
      read_fields(finding_fields(), row, one);
      one.subject = kOfRecording;
      if (one.severity != Severity::note && !one.effects.empty()) out.push_back(std::move(one));
    }
  const MapReader rows = document.has("summary") ? document.map("summary") : document;
  if (!rows.has("channels")) return out;
  for (const MapReader& channel : rows.maps("channels")) {
    if (!channel.has("name") || !channel.has("findings")) continue;
    for (const MapReader& row : channel.maps("findings")) {
      Finding one;
      read_fields(finding_fields(), row, one);
      one.subject = channel.text("name");
      if (one.severity != Severity::note) out.push_back(std::move(one));
    }
  }
  return worst_first(std::move(out));
}

}  // namespace libchar::detail

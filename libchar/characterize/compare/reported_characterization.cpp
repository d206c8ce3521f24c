#include "libchar/characterize/compare/reported_characterization.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "libchar/characterize/compare/reported_findings.hpp"
#include "libchar/core/document/document.hpp"
#include "libchar/core/document/json_reader.hpp"
#include "libchar/core/document/schema.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/fit/fit_json.hpp"

namespace libchar {
namespace {

constexpr std::string_view kFormats[] = {"characterization", "pooled-runs", "noise-fit"};

std::string format_of(const Document& document) {
  const DocumentEntry* const format =
      document.kind == Document::Kind::map ? document.find("format") : nullptr;
  return format != nullptr && format->value.kind == Document::Kind::text ? format->value.text : "";
}

/// "" where it cannot be read.
std::string format_in(const std::string& file) {
  try {
    return format_of(parse_json_document(read_document_text(file), file));
  } catch (const Error&) {
    return "";
  }
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

ReportedCharacterization read_summary(const Document& document, const std::string& file) {
  const std::string format = format_of(document);
  if (!is_known(format))
    throw input_error("E0771", file)
        .says(
            "expected the report of a characterization (format characterization, pooled-runs or "
            "noise-fit)")
        .got(format)
        .hint("the report.json of a characterization is one");
  check_format(document, file, format, 1);
  ReportedCharacterization out;
  out.file = file;
  out.format = format;
  const MapReader map(document, file, "");
  if (map.has("tool")) out.program = map.map("tool").text_or("version", "");
  out.recording = recording_of(map);
  const MapReader fit = format == "noise-fit" ? map : map.map("fit");
  for (const MapReader& one : fit.maps("channels")) {
    out.channels.push_back(read_channel(one));
    if (out.find(out.channels.back().name) != &out.channels.back())
      fit.refuse("channels", "two channels have one name: " + out.channels.back().name);
  }
  out.findings = detail::reported_findings(map);
  return out;
}

}  // namespace

const ReportedChannel* ReportedCharacterization::find(std::string_view name) const {
  for (const ReportedChannel& c : channels)
    if (c.name == name) return &c;
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

bool is_characterization_report(const std::string& path) {
  return is_known(format_in(report_file(path)));
}

void refuse_lot_report(const std::string& path, const std::string& instead) {
  std::error_code ignored;
  std::string file = report_file(path);
  if (!std::filesystem::exists(file, ignored))
    file = (std::filesystem::path(path) / "lot.json").string();
  if (format_in(file) == "lot")
    throw input_error("E0771", file)
        .says("this is the report of a lot of devices")
        .got("lot")
        .hint(instead);
}

ReportedCharacterization parse_characterization_report(std::string_view text,
                                                       const std::string& path) {
  return read_summary(parse_json_document(text, path), path);
}

ReportedCharacterization read_characterization_report(const std::string& path) {
  const std::string file = report_file(path);
  return parse_characterization_report(read_document_text(file), file);
}

}  // namespace libchar

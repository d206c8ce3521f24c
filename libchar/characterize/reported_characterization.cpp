#include "libchar/characterize/reported_characterization.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "libchar/core/document_file.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/json_reader.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/output_files.hpp"
#include "libchar/core/schema.hpp"

namespace libchar {
namespace {

constexpr std::string_view kFormats[] = {"characterization", "pooled-runs", "noise-fit"};

// A report grows keys from version to version of the program: those we do not know are left alone.
MapReader open_level(const Document& node, const std::string& file, const std::string& path) {
  std::vector<std::string> keys;
  for (const DocumentEntry& entry : node.map) keys.push_back(entry.key);
  return {node, file, path, std::move(keys)};
}

MapReader open_level(const MapReader& map, const std::string& key) {
  return open_level(map.require(key), map.file(), map.path_of(key));
}

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

Coefficient read_coefficient(const MapReader& map) {
  Coefficient c;
  const auto status = find_enum<Status>(map.word("status", words_of<Status>()));
  c.status = *status;
  c.value = map.maybe_number("value", kNotNegative);
  c.upper95 = map.maybe_number("upper95", kNotNegative);
  c.relative_sd = map.number_or("relative_sd", 0, kNotNegative);
  if (!c.value) return c;
  const auto ends = map.interval("ci95");
  c.ci95 = {ends.first, ends.second};
  if (!(ends.first <= *c.value && *c.value <= ends.second))
    map.refuse("ci95", "the interval does not hold the value");
  return c;
}

FitBand read_band(const MapReader& map) {
  FitBand band;
  band.top_hz = map.number_or("top_hz", kNone);
  band.whole = map.flag_or("whole", true);
  band.orders = static_cast<int>(map.count_or("shape_coefficients", 0));
  return band;
}

std::string read_shape(const MapReader& map) {
  const std::string kind = map.text_or("kind", "none");
  const std::uint64_t taps = map.count_or("taps", 0);
  return taps > 0 ? fmt::format("{} of {}", kind, taps) : kind;
}

ReportedChannel read_channel(const MapReader& map) {
  ReportedChannel out;
  out.name = map.text("name");
  out.unit = map.text_or("unit", "");
  out.fitted = map.has("goodness");
  if (!out.fitted) return out;
  for (std::size_t t = 0; t < kTerms; ++t)
    out.term[t] = read_coefficient(open_level(map, std::string(kTermNames[t].key)));
  out.p = open_level(map, "goodness").number_or("p", kNone);
  out.rate_hz = map.number("rate_hz", kPositive);
  out.duration_s = map.number("duration_s", kPositive);
  if (map.has("band")) out.band = read_band(open_level(map, "band"));
  if (map.has("shape")) out.shape = read_shape(open_level(map, "shape"));
  if (map.has("events")) out.events = map.list("events").size();
  return out;
}

std::string recording_of(const MapReader& map) {
  if (!map.has("input")) return "";
  const std::vector<Document>& input = map.list("input");
  if (input.empty()) return "";
  const std::string first = open_level(input[0], map.file(), "input[0]").text_or("path", "");
  return input.size() == 1 ? first : fmt::format("{} and {} more", first, input.size() - 1);
}

ReportedCharacterization read_summary(const Document& document, const std::string& file) {
  const std::string format = format_of(document);
  if (!is_known(format))
    throw Error({ErrorKind::input,
                 "E0771",
                 file,
                 "expected the report of a characterization (format characterization, pooled-runs "
                 "or noise-fit)",
                 format,
                 "the report.json of a characterization is one"});
  check_format(document, file, format, 1);
  ReportedCharacterization out;
  out.file = file;
  out.format = format;
  const MapReader map = open_level(document, file, "");
  if (map.has("tool")) out.program = open_level(map, "tool").text_or("version", "");
  out.recording = recording_of(map);
  const MapReader fit = format == "noise-fit" ? map : open_level(map, "fit");
  std::size_t i = 0;
  for (const Document& one : fit.list("channels")) {
    out.channels.push_back(
        read_channel(open_level(one, file, fmt::format("{}[{}]", fit.path_of("channels"), i++))));
    if (out.find(out.channels.back().name) != &out.channels.back())
      fit.refuse("channels", "two channels have one name: " + out.channels.back().name);
  }
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
    throw Error({ErrorKind::input,
                 "E0771",
                 file,
                 "this is the report of a lot of devices",
                 "lot",
                 instead});
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

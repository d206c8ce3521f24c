#include "libchar/figure/figure_source.hpp"

#include <fmt/format.h>

#include "libchar/characterize/compare/reported_characterization.hpp"
#include "libchar/core/document/document.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/figure/detail/figure_parts.hpp"
#include "libchar/fit/curve/curve_table.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/replay/report/replay_report.hpp"

namespace libchar {
namespace {

constexpr const char* kReadable =
    "plot draws report.json of characterize or replay (or its folder), what allan, psd and fit print, "
    "curves.csv, and sensor models";

std::string format_in(const Document& document) {
  const DocumentEntry* entry = document.kind == Document::Kind::map ? document.find("format") : nullptr;
  return entry != nullptr && entry->value.kind == Document::Kind::text ? entry->value.text : "";
}

[[noreturn]] void refuse_document(const std::string& file, const std::string& format) {
  const bool scene = format == "scene" || format == "fusion-scene";
  throw input_error("E0975", file)
      .says(format.empty() ? "a document that names no format" : "a document of a format that is not drawn")
      .got(format)
      .hint(scene ? fmt::format("sensorchar replay {} -o DIR makes a report, which is drawn", file) : kReadable);
}

[[noreturn]] void refuse_log(const std::string& file) {
  throw input_error("E0975", file)
      .says("is not a report, curve or sensor model; is it a log?")
      .hint(
          "sensorchar allan {0} -o curve.csv (or psd) makes a curve of a log, sensorchar characterize {0} -o DIR a "
          "report: plot these",
          file);
}

void read_document(FigureSource& out, const Document& document, const std::string& file) {
  const std::string format = format_in(document);
  if (format == "replay-report") {
    out.replay = std::make_shared<const ReplayReport>(parse_replay_report(document, file));
    return;
  }
  const bool known = format == "characterization" || format == "allan" || format == "spectrum" ||
                     format == "noise-fit" || format == "pooled-runs";
  if (!known) refuse_document(file, format);
  check_format(document, file, format, 1);
  const MapReader map(document, file, "");
  out.findings = detail::reported_findings(map);
  if (format == "allan") return add_allan_curves(out, map);
  if (format == "spectrum") return add_spectra(out, map);
  if (format == "noise-fit") {
    add_residuals(out, map);
    return add_fits(out, map);
  }
  if (map.has("allan")) add_allan_curves(out, map.map("allan"));
  if (map.has("spectrum")) add_spectra(out, map.map("spectrum"));
  if (map.has("fit")) {
    add_residuals(out, map.map("fit"));
    add_fit_to_curves(out, map.map("fit"));
  }
  if (map.has("trace")) add_traces(out, map.map("trace"));
  if (map.has("verification")) add_simulated(out, map.map("verification"));
}

void refuse_empty(const FigureSource& source) {
  if (source.replay || !source.curves.empty() || !source.residuals.empty() || !source.traces.empty()) return;
  throw input_error("E0975", source.file).says("holds no curve that could be drawn").hint(kReadable);
}

void read_table(FigureSource& out, const std::string& file) {
  const std::string held = curve_in_header(file);
  if (held.empty()) refuse_log(file);
  for (const bool is_allan : {true, false}) {
    if (held.find(is_allan ? "allan" : "psd") == std::string::npos) continue;
    try {
      add_table(out, file, is_allan);
    } catch (const Error& error) {
      // A table that may hold both holds one of them at least.
      if (error.problem().code != "E0802" || (!is_allan && out.curves.empty())) throw;
    }
  }
}

}  // namespace

FigureSource parse_figure_source(std::string_view text, const std::string& path) {
  FigureSource out;
  out.file = path;
  out.name = detail::document_name(path);
  read_document(out, parse_json_document(text, path), path);
  refuse_empty(out);
  return out;
}

FigureSource read_figure_source(const std::string& path) {
  FigureSource out;
  out.file = report_file(path);
  out.name = detail::document_name(out.file);
  if (!detail::ends_like_a_document(out.file)) {
    read_table(out, out.file);
    refuse_empty(out);
    return out;
  }
  const std::string text = read_document_text(out.file);
  const Document document = parse_document(text, out.file);
  if (detail::holds_models(document)) {
    for (const SensorModel& model : read_model_list(out.file)) add_model(out, model);
  } else {
    read_document(out, document, out.file);
  }
  refuse_empty(out);
  return out;
}

}  // namespace libchar

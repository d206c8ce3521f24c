// report.json: the documents of every verb in one frame, and what the report adds to them.

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "libchar/characterize/curves/curve_document.hpp"
#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/fit/fit_json.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/report/detail/report_rows.hpp"
#include "libchar/report/html/html_report.hpp"
#include "libchar/report/text/curves_text.hpp"

namespace libchar {
namespace {

DerivedNumbers derived_of(const ChannelView& view) {
  DerivedNumbers out;
  out.per_sample_sd = view.per_sample_sd;
  out.noise_density_one_sided = view.noise_density_one_sided;
  if (view.allan_minimum != nullptr) out.allan_minimum = *view.allan_minimum;
  out.read_off_points = view.read_off;
  out.plain_from_s = view.plain_from_s;
  return out;
}

QualityOfChannel quality_of(const ChannelResult& c) { return {{c.channel, c.quality}, c.digital, c.lines}; }

// Enough digits for a picture.
std::vector<double> for_drawing(const std::vector<double>& values, int digits) {
  std::vector<double> out;
  for (const double value : values) out.push_back(std::isfinite(value) ? rounded(value, digits) : value);
  return out;
}

TraceOfChannel trace_of(const ChannelView& view) {
  const ChannelResult& channel = *view.result;
  TraceOfChannel out{channel.channel.name, channel.trace_unit, channel.trace, view.marks, channel.channel.rate_hz};
  Trace& trace = out.trace;
  double least = INFINITY, most = -INFINITY;
  for (std::size_t i = 0; i < trace.low.size(); ++i) {
    if (trace.low[i] < least) least = trace.low[i];
    if (trace.high[i] > most) most = trace.high[i];
  }
  const double largest = std::max(std::fabs(least), std::fabs(most));
  const double digits = most > least ? std::ceil(std::log10(largest / (most - least))) + 4 : 4;
  const int enough = std::isfinite(digits) ? static_cast<int>(std::clamp(digits, 4.0, 17.0)) : 17;
  trace.low = for_drawing(trace.low, enough);
  trace.high = for_drawing(trace.high, enough);
  return out;
}

SummaryOfChannel summary_of(const ChannelView& view) {
  return {view.result->channel.name, view.judgement.rating, view.summary, view.judgement.findings};
}

Json verification_json(const ChannelView& view) {
  const ChannelResult& c = *view.result;
  if (c.verification == nullptr) return nullptr;
  return document_of(verification_fields(),
                     {c.channel.name, *c.verification, allan_of_channel(c.channel, c.verification->allan),
                      spectrum_of_channel(c.channel, c.verification->spectrum, view.verification_ci95)});
}

// A channel that could not be fitted keeps its place: null, its findings say why.
Json fit_or_reason(const ChannelView& view) {
  const ChannelResult& channel = *view.result;
  const std::string name = json_text(channel.channel.name), unit = json_text(channel.channel.unit);
  if (!channel.fit) return no_fit_json(name, unit);
  Json out = noise_fit_json(name, unit, *channel.fit, true);
  out["derived"] = document_of(derived_fields(), derived_of(view));
  return out;
}

AllanOfChannel allan_of(const ChannelView& view) {
  const ChannelResult& c = *view.result;
  AllanOfChannel out = allan_of_channel(c.channel, c.allan, view.allan_model ? &*view.allan_model : nullptr);
  out.noise_types = c.noise_types;
  for (const auto& value : view.data_sheet) out.data_sheet.push_back(value.value_or(kNone));
  return out;
}

SpectrumOfChannel spectrum_of(const ChannelView& view) {
  return spectrum_of_channel(view.result->channel, view.result->spectrum, view.spectrum_ci95,
                             view.spectrum_model ? &*view.spectrum_model : nullptr);
}

}  // namespace

Json json_without_times(const CharacterizationView& view) {
  const Characterization& result = *view.result;
  Json out = document_head("characterization", result.command, {&result.log});
  out["config"] = json_of(result.settings);
  out["verdict"] = json_text(view.verdict);
  out["summary"] = {{"rating", name_of(view.rating)}, {"channels", Json::array()}};
  for (const ChannelView& v : view.channels)
    out["summary"]["channels"].push_back(document_of(summary_fields(), summary_of(v)));

  std::vector<ChannelQuality> qualities;
  LogInfo log = result.log;
  log.channels.clear();
  for (const ChannelResult& c : result.channels) {
    log.channels.push_back(c.channel);
    qualities.push_back(c.quality);
  }
  out["recording"] = recording_json(log, qualities);
  if (result.still) out["still"] = document_of(still_fields(), *result.still);

  AllanDocument allan;
  SpectrumDocument spectrum;
  Json fit = noise_fit_document(Json::array()), quality = {{"channels", Json::array()}};
  const ChannelResult none, &first = result.channels.empty() ? none : result.channels[0];
  allan.type = name_of(first.allan.type);
  spectrum.sides = name_of(first.spectrum.sides);
  spectrum.scaling = name_of(first.spectrum.scaling);
  for (const ChannelView& v : view.channels) {
    allan.channels.push_back(allan_of(v));
    spectrum.channels.push_back(spectrum_of(v));
    fit["channels"].push_back(fit_or_reason(v));
    quality["channels"].push_back(document_of(quality_fields(), quality_of(*v.result)));
  }
  out["allan"] = document_of(allan_fields(), allan);
  out["spectrum"] = document_of(spectrum_fields(), spectrum);
  out["fit"] = std::move(fit);
  out["quality"] = std::move(quality);
  out["trace"] = {{"rate_hz", json_number(result.log.time.rate_hz)}, {"channels", Json::array()}};
  for (const ChannelView& v : view.channels)
    out["trace"]["channels"].push_back(document_of(trace_fields(), trace_of(v)));
  if (std::any_of(result.channels.begin(), result.channels.end(),
                  [](const ChannelResult& c) { return c.verification != nullptr; })) {
    out["verification"] = {{"channels", Json::array()}};
    for (const ChannelView& v : view.channels) out["verification"]["channels"].push_back(verification_json(v));
  }
  if (result.limits) out["limits"] = document_of(limit_report_fields(), *result.limits);
  return out;
}

Json json_report(const CharacterizationView& view) {
  Json out = json_without_times(view);
  add_times(out, *view.result);
  return out;
}

Json json_report(const Characterization& result) { return json_report(characterization_view(result)); }

void add_times(Json& document, const Characterization& result) {
  if (std::isfinite(result.seconds))
    document["measured"] = {{"seconds", result.seconds}, {"work", work_json(result.work)}};
}

std::vector<OutputFile> report_files(const CharacterizationView& view, const std::filesystem::path& folder) {
  const Characterization& result = *view.result;
  Json document = json_without_times(view);
  std::vector<OutputFile> outputs = {{(folder / "report.html").string(), html_report(view, document)}};
  add_times(document, result);
  outputs.push_back({(folder / "report.json").string(), ""});
  outputs.push_back({(folder / "curves.csv").string(), csv_curves(view)});
  std::set<std::string> taken;
  for (const ChannelResult& c : result.channels) {
    if (!c.fit) continue;
    const std::string name = unused_file_name_for(c.channel.name, taken);
    outputs.push_back({(folder / (name + ".sensor.yaml")).string(), model_yaml(sensor_model_from(c, result.log))});
  }
  name_files(document, outputs);
  outputs[1].text = dump_json(document);
  return outputs;
}

}  // namespace libchar

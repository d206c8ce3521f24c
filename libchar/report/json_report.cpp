// report.json: the documents of every verb in one frame, and what the report adds to them.

#include "libchar/report/json_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/characterize/verification.hpp"
#include "libchar/core/decimal.hpp"
#include "libchar/fit/fit_json.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/json_pieces.hpp"
#include "libchar/report/detail/limits_pieces.hpp"
#include "libchar/report/detail/verification_json.hpp"

namespace libchar {
namespace {

Json read_off_json(const std::vector<ReadOff>& points) {
  Json out = Json::array();
  for (const ReadOff& p : points) {
    out.push_back({{"term", kTermNames[static_cast<std::size_t>(p.term)].key},
                   {"tau_s", p.tau_s},
                   {"deviation", p.deviation},
                   {"label", p.label}});
  }
  return out;
}

// Numbers that follow from the coefficients and that one asks for.
Json derived_json(const ChannelView& view) {
  Json out = Json::object();
  if (view.per_sample_sd) {
    out["per_sample_sd"] = *view.per_sample_sd;
    out["noise_density_one_sided"] = *view.noise_density_one_sided;
  }
  if (const AllanPoint* lowest = view.allan_minimum) {
    out["allan_minimum"] = {{"deviation", lowest->deviation}, {"tau_s", lowest->tau_s}};
  }
  out["read_off_points"] = read_off_json(view.read_off);
  out["plain_from_s"] = view.plain_from_s;
  return out;
}

Json digital_json(const DigitalFaults& faults) {
  Json out = {{"rails", Json::array()}, {"held", nullptr}, {"staircase", nullptr}};
  for (const Rail& rail : faults.rails)
    out["rails"].push_back({{"value", rail.value}, {"high", rail.high}, {"share", rail.share}});
  if (faults.held)
    out["held"] = {{"times", faults.held->times}, {"sensor_rate_hz", faults.held->sensor_rate_hz}};
  if (faults.staircase)
    out["staircase"] = {{"step", faults.staircase->step},
                        {"noise", faults.staircase->noise},
                        {"bounded", faults.staircase->bounded}};
  return out;
}

Json quality_json(const ChannelResult& channel) {
  Json out = channel_json(channel.channel, channel.quality);
  out["digital"] = digital_json(channel.digital);
  out["lines"] = Json::array();
  for (const SpectralLine& line : channel.lines) {
    out["lines"].push_back({{"frequency_hz", line.frequency_hz},
                            {"amplitude", line.amplitude},
                            {"excess", line.excess},
                            {"width_hz", line.width_hz}});
  }
  out["problems"] = Json::array();
  for (const std::string& problem : channel.problems) out["problems"].push_back(json_text(problem));
  return out;
}

// Enough digits for a picture.
Json for_drawing(const std::vector<double>& values, int digits) {
  Json out = Json::array();
  for (const double value : values)
    out.push_back(std::isfinite(value) ? Json(rounded(value, digits)) : Json(nullptr));
  return out;
}

// The record in blocks, with what was found in it.
Json trace_json(const ChannelView& view) {
  const ChannelResult& channel = *view.result;
  const Trace& trace = channel.trace;
  double least = INFINITY, most = -INFINITY;
  for (std::size_t i = 0; i < trace.low.size(); ++i) {
    if (trace.low[i] < least) least = trace.low[i];
    if (trace.high[i] > most) most = trace.high[i];
  }
  const double largest = std::max(std::fabs(least), std::fabs(most));
  const double digits = most > least ? std::ceil(std::log10(largest / (most - least))) + 4 : 4;
  Json out = {{"name", json_text(channel.channel.name)},
              {"unit", json_text(channel.trace_unit)},
              {"samples_per_block", trace.block}};
  const int enough = std::isfinite(digits) ? static_cast<int>(std::clamp(digits, 4.0, 17.0)) : 17;
  out["low"] = for_drawing(trace.low, enough);
  out["high"] = for_drawing(trace.high, enough);
  out["missing"] = Json::array();
  for (std::size_t i = 0; i < trace.missing.size(); ++i)
    if (trace.missing[i] > 0) out["missing"].push_back({i, trace.missing[i]});
  out["marks"] = Json::array();
  for (const TraceMark& mark : view.marks)
    out["marks"].push_back({{"kind", mark.kind},
                            {"from_s", mark.from_s},
                            {"to_s", mark.to_s},
                            {"label", json_text(mark.label)}});
  return out;
}

Json summary_json(const ChannelView& view) {
  Json spoils = Json::array();
  for (const Objection& objection : view.judgement.objections)
    spoils.push_back(json_text(objection.phrase));
  return {{"name", json_text(view.result->channel.name)},
          {"rating", name_of(view.judgement.rating)},
          {"sentence", json_text(view.summary)},
          {"spoils", std::move(spoils)}};
}

// A channel that could not be fitted keeps its place: null, with the objection in "problems".
Json fit_or_reason(const ChannelView& view) {
  const ChannelResult& channel = *view.result;
  const std::string name = json_text(channel.channel.name), unit = json_text(channel.channel.unit);
  if (!channel.fit) return no_fit_json(name, unit);
  Json out = noise_fit_json(name, unit, *channel.fit, true);
  out["derived"] = derived_json(view);
  return out;
}

Json noise_types_json(const std::vector<NoiseType>& types) {
  Json list = Json::array();
  for (const NoiseType& type : types)
    list.push_back({{"tau_s", json_number(type.tau_s)},
                    {"alpha", type.alpha},
                    {"estimate", json_number(type.estimate)},
                    {"name", noise_type_name(type.alpha)}});
  return list;
}

Json allan_json_of(const ChannelView& view) {
  const ChannelResult& c = *view.result;
  Json out =
      allan_channel_json(c.channel, c.allan, view.allan_model ? &*view.allan_model : nullptr);
  if (!c.noise_types.empty()) out["noise_types"] = noise_types_json(c.noise_types);
  if (view.data_sheet.empty()) return out;
  Json& line = out["data_sheet"] = Json::array();
  for (const auto& value : view.data_sheet) line.push_back(json_number(value));
  return out;
}

}  // namespace

Json json_without_times(const CharacterizationView& view) {
  const Characterization& result = *view.result;
  Json out = document_head("characterization", result.command, {&result.log});
  out["config"] = json_of(result.settings);
  out["verdict"] = json_text(view.verdict);
  out["summary"] = {{"rating", name_of(view.rating)}, {"channels", Json::array()}};
  for (const ChannelView& v : view.channels) out["summary"]["channels"].push_back(summary_json(v));

  std::vector<ChannelQuality> qualities;
  LogInfo log = result.log;
  log.channels.clear();
  for (const ChannelResult& c : result.channels) {
    log.channels.push_back(c.channel);
    qualities.push_back(c.quality);
  }
  out["recording"] = recording_json(log, qualities);
  if (result.still)
    out["still"] = {{"from_s", result.still->from_s},
                    {"to_s", result.still->to_s},
                    {"found", result.still->found},
                    {"whole", result.still->whole},
                    {"sentence", json_text(result.still->sentence)}};

  Json allan = json_frame("allan"), spectrum = json_frame("spectrum"),
       fit = noise_fit_document(Json::array()), quality = Json::object();
  const bool any = !result.channels.empty();
  allan["type"] = name_of(any ? result.channels[0].allan.type : DeviationType::oadev);
  spectrum["sides"] = name_of(any ? result.channels[0].spectrum.sides : Sides::one);
  spectrum["scaling"] = name_of(any ? result.channels[0].spectrum.scaling : Scaling::psd);
  for (Json* part : {&allan, &spectrum, &quality}) (*part)["channels"] = Json::array();
  for (const ChannelView& v : view.channels) {
    const ChannelResult& c = *v.result;
    allan["channels"].push_back(allan_json_of(v));
    spectrum["channels"].push_back(spectrum_channel_json(
        c.channel, c.spectrum, v.spectrum_model ? &*v.spectrum_model : nullptr, v.spectrum_ci95));
    fit["channels"].push_back(fit_or_reason(v));
    quality["channels"].push_back(quality_json(c));
  }
  out["allan"] = std::move(allan);
  out["spectrum"] = std::move(spectrum);
  out["fit"] = std::move(fit);
  out["quality"] = std::move(quality);
  out["trace"] = {{"rate_hz", json_number(result.log.time.rate_hz)}, {"channels", Json::array()}};
  for (const ChannelView& v : view.channels) out["trace"]["channels"].push_back(trace_json(v));
  if (std::any_of(result.channels.begin(), result.channels.end(), [](const ChannelResult& c) {
        return c.verification != nullptr;
      })) {
    out["verification"] = {{"channels", Json::array()}};
    for (const ChannelView& v : view.channels)
      out["verification"]["channels"].push_back(v.result->verification ? verification_json(v)
                                                                       : Json(nullptr));
  }
  if (result.limits) out["limits"] = limits_json(*result.limits);
  return out;
}

Json json_report(const CharacterizationView& view) {
  Json out = json_without_times(view);
  add_times(out, *view.result);
  return out;
}

Json json_report(const Characterization& result) {
  return json_report(characterization_view(result));
}

void add_times(Json& document, const Characterization& result) {
  if (std::isfinite(result.seconds))
    document["measured"] = {{"seconds", result.seconds}, {"work", work_json(result.work)}};
}

}  // namespace libchar

// report.json: the documents of every verb in one frame, and what the report adds to them.

#include "libchar/report/json_report.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/characterize/verification.hpp"
#include "libchar/fit/fit_json.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/json_pieces.hpp"
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

// A channel that could not be fitted keeps its place: null, with the reason in "problems".
Json fit_or_reason(const ChannelView& view) {
  const ChannelResult& channel = *view.result;
  const std::string name = json_text(channel.channel.name), unit = json_text(channel.channel.unit);
  if (!channel.fit) return no_fit_json(name, unit);
  Json out = noise_fit_json(name, unit, *channel.fit, true);
  out["derived"] = derived_json(view);
  return out;
}

}  // namespace

Json json_without_times(const CharacterizationView& view) {
  const Characterization& result = *view.result;
  Json out = document_head("characterization", result.command, {&result.log});
  out["config"] = json_of(result.settings);
  out["verdict"] = json_text(view.verdict);

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
    allan["channels"].push_back(
        allan_channel_json(c.channel, c.allan, v.allan_model ? &*v.allan_model : nullptr));
    spectrum["channels"].push_back(spectrum_channel_json(
        c.channel, c.spectrum, v.spectrum_model ? &*v.spectrum_model : nullptr, v.spectrum_ci95));
    fit["channels"].push_back(fit_or_reason(v));
    quality["channels"].push_back(quality_json(c));
  }
  out["allan"] = std::move(allan);
  out["spectrum"] = std::move(spectrum);
  out["fit"] = std::move(fit);
  out["quality"] = std::move(quality);
  if (std::any_of(result.channels.begin(), result.channels.end(), [](const ChannelResult& c) {
        return c.verification != nullptr;
      })) {
    out["verification"] = {{"channels", Json::array()}};
    for (const ChannelView& v : view.channels)
      out["verification"]["channels"].push_back(v.result->verification ? verification_json(v)
                                                                       : Json(nullptr));
  }
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
  document["measured"] = {{"seconds", result.seconds}};
}

}  // namespace libchar

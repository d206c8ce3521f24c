#include "libchar/report/text/devices_text.hpp"

#include <nlohmann/json.hpp>

#include "libchar/core/text/csv_cell.hpp"
#include "libchar/report/detail/json_pieces.hpp"

namespace libchar {
namespace {

Json channel_head(const Channel& channel) {
  return {{"name", json_text(channel.name)}, {"unit", json_text(channel.unit)}};
}

Json notes_json(const std::vector<std::string>& notes) {
  Json out = Json::array();
  for (const std::string& note : notes) out.push_back(json_text(note));
  return out;
}

double middle_s(const DynamicWindow& window) {
  return (window.from_s + window.to_s) / 2;
}

}  // namespace

std::string hat_csv(const LogHat& hat) {
  std::string text = "channel,unit,tau_s,deviation,variance,variance_sd,status,terms\n";
  for (std::size_t c = 0; c < hat.channels.size(); ++c)
    for (const HatPoint& p : hat.hat.devices[c])
      text += csv_line(hat.channels[c].name,
                       hat.channels[c].unit,
                       p.tau_s,
                       p.deviation,
                       p.variance,
                       p.variance_sd,
                       name_of(p.status),
                       p.terms);
  return text;
}

Json hat_json(const LogHat& hat) {
  Json out = json_frame("cornered-hat");
  out["type"] = name_of(hat.hat.type);
  out["channels"] = Json::array();
  for (std::size_t c = 0; c < hat.channels.size(); ++c) {
    Json channel = channel_head(hat.channels[c]);
    for (const char* key :
         {"tau_s", "deviation", "variance", "variance_sd", "status", "terms", "m"})
      channel[key] = Json::array();
    for (const HatPoint& p : hat.hat.devices[c]) {
      channel["tau_s"].push_back(p.tau_s);
      channel["deviation"].push_back(json_number(p.deviation));
      channel["variance"].push_back(json_number(p.variance));
      channel["variance_sd"].push_back(json_number(p.variance_sd));
      channel["status"].push_back(name_of(p.status));
      channel["terms"].push_back(p.terms);
      channel["m"].push_back(p.m);
    }
    out["channels"].push_back(std::move(channel));
  }
  out["notes"] = notes_json(hat.hat.notes);
  return out;
}

std::string dynamic_csv(const LogDynamic& dynamic) {
  std::string text = "channel,unit,time_s,from_s,to_s,tau_s,deviation,terms\n";
  for (std::size_t c = 0; c < dynamic.channels.size(); ++c)
    for (const DynamicWindow& window : dynamic.deviations[c].windows)
      for (const AllanPoint& p : window.curve.points)
        text += csv_line(dynamic.channels[c].name,
                         dynamic.channels[c].unit,
                         middle_s(window),
                         window.from_s,
                         window.to_s,
                         p.tau_s,
                         p.deviation,
                         p.terms);
  return text;
}

Json dynamic_json(const LogDynamic& dynamic) {
  Json out = json_frame("dynamic-allan");
  out["type"] =
      name_of(dynamic.deviations.empty() ? DeviationType::oadev : dynamic.deviations[0].type);
  out["channels"] = Json::array();
  for (std::size_t c = 0; c < dynamic.channels.size(); ++c) {
    Json channel = channel_head(dynamic.channels[c]);
    channel["windows"] = Json::array();
    for (const DynamicWindow& window : dynamic.deviations[c].windows) {
      Json one = {{"time_s", middle_s(window)}, {"from_s", window.from_s}, {"to_s", window.to_s}};
      for (const char* key : {"tau_s", "deviation", "terms"}) one[key] = Json::array();
      for (const AllanPoint& p : window.curve.points) {
        one["tau_s"].push_back(p.tau_s);
        one["deviation"].push_back(json_number(p.deviation));
        one["terms"].push_back(p.terms);
      }
      channel["windows"].push_back(std::move(one));
    }
    channel["notes"] = notes_json(dynamic.deviations[c].notes);
    out["channels"].push_back(std::move(channel));
  }
  return out;
}

}  // namespace libchar

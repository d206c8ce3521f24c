// A record as a line of JSON. detail/record_scanner.cpp reads such lines as they are written here, key by key.
#include <nlohmann/json.hpp>

#include "libchar/core/json.hpp"
#include "libchar/lot/device_record.hpp"

namespace libchar {
namespace {

Json value_json(const RecordedValue& v) {
  Json out = {{"status", std::string(name_of(v.status))}};
  if (!std::isnan(v.value)) {
    out["value"] = json_number(v.value);
    out["ci95"] = Json::array({json_number(v.ci95.low), json_number(v.ci95.high)});
    out["sd"] = json_number(v.sd);
  }
  if (v.in_all)
    out["square_in_all"] = Json::array({json_number(v.in_all->square),
                                        json_number(v.in_all->sd),
                                        json_number(v.in_all->skewness)});
  if (!std::isnan(v.upper95)) out["upper95"] = json_number(v.upper95);
  return out;
}

Json channel_json(const RecordedChannel& c) {
  Json out = {{"name", json_text(c.name)},
              {"unit", json_text(c.unit)},
              {"samples", c.samples},
              {"missing", c.missing}};
  if (!std::isnan(c.mean)) out["mean"] = json_number(c.mean);
  if (c.fitted) {
    out["rate_hz"] = json_number(c.rate_hz);
    out["duration_s"] = json_number(c.duration_s);
    out["p"] = json_number(c.p);
    out["values"] = Json::object();
    for (const RecordedValue& v : c.values)
      out["values"][std::string(name_of(v.quantity))] = value_json(v);
  }
  for (const std::string& problem : c.problems) out["problems"].push_back(json_text(problem));
  return out;
}

}  // namespace

std::string device_record_text(const DeviceRecord& record) {
  Json out = {{"format", "device-record"},
              {"version", 1},
              {"device", json_text(record.device)},
              {"type", json_text(record.type)},
              {"batch", json_text(record.batch)},
              {"log", json_text(record.log)},
              {"sha256", record.sha256},
              {"settings", json_text(record.settings)},
              {"program", record.program}};
  if (record.temperature_c) out["temperature_c"] = json_number(record.temperature_c);
  for (const auto& [key, text] : {std::pair("report", &record.report),
                                  std::pair("limits", &record.limits),
                                  std::pair("problem", &record.problem)})
    if (!text->empty()) out[key] = json_text(*text);
  for (const std::string& warning : record.warnings) out["warnings"].push_back(json_text(warning));
  out["channels"] = Json::array();
  for (const RecordedChannel& channel : record.channels)
    out["channels"].push_back(channel_json(channel));
  return with_valid_text(std::move(out)).dump();
}

}  // namespace libchar

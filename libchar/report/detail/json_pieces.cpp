#include "libchar/report/detail/json_pieces.hpp"

// The JSON pieces that the verbs share; the keys are those of docs/json.md, which may grow and
// never change.

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/core/units.hpp"
#include "libchar/report/detail/escape.hpp"

namespace libchar {
namespace {

Json named(const Channel& channel) {
  return {{"name", json_text(channel.name)}, {"unit", json_text(channel.unit)}};
}

// Each a straight line on logarithmic axes: two points.
Json asymptotes_json(const std::vector<Asymptote>& lines) {
  Json out = Json::object();
  for (const Asymptote& a : lines) {
    out[std::string(kTermNames[static_cast<std::size_t>(a.term)].key)] = {{a.x[0], a.y[0]},
                                                                          {a.x[1], a.y[1]}};
  }
  return out;
}

void add_model(Json& out, const ModelCurve& model) {
  out["model"] = Json::array();
  for (const auto& value : model.values) out["model"].push_back(json_number(value));
  if (!model.intervals.empty()) out["model_ci95"] = Json::array();
  for (const auto& interval : model.intervals)
    out["model_ci95"].push_back(interval ? interval_json(*interval) : Json(nullptr));
  out["asymptotes"] = asymptotes_json(model.asymptotes);
}

}  // namespace

Json texts_json(const std::vector<std::string>& texts) {
  Json out = Json::array();
  for (const std::string& text : texts) out.push_back(json_text(text));
  return out;
}

Json json_frame(std::string_view format) {
  return {{"format", format}, {"version", 1}};
}

Json warnings_json(const Warnings& warnings) {
  Json out = Json::array();
  for (const Warning& w : warnings.list())
    out.push_back({{"code", json_text(w.code)},
                   {"message", json_text(w.message)},
                   {"count", w.count},
                   {"where", texts_json(w.places)}});
  return out;
}

Json interval_json(const Interval& interval) {
  if (std::isnan(interval.low) || std::isnan(interval.high)) return nullptr;
  return Json::array({json_number(interval.low), json_number(interval.high)});
}

Json allan_channel_json(const Channel& channel, const AllanCurve& curve, const ModelCurve* model) {
  Json out = named(channel);
  if (const std::string unit = deviation_unit(curve.type, channel.unit); unit != channel.unit)
    out["value_unit"] = unit;
  for (const char* key : {"tau_s", "deviation", "ci95", "edf", "terms", "m", "ci68", "reliable"})
    out[key] = Json::array();
  for (const AllanPoint& p : curve.points) {
    const bool known = p.edf > 0;
    out["tau_s"].push_back(p.tau_s);
    out["deviation"].push_back(json_number(p.deviation));
    out["ci95"].push_back(known ? interval_json(p.ci95) : Json(nullptr));
    out["edf"].push_back(known ? json_number(p.edf) : Json(nullptr));
    out["terms"].push_back(p.terms);
    out["m"].push_back(p.m);
    out["ci68"].push_back(known ? interval_json(p.ci68) : Json(nullptr));
    out["reliable"].push_back(p.reliable);
  }
  if (std::any_of(curve.points.begin(), curve.points.end(), [](const AllanPoint& p) {
        return p.bias != 1;
      })) {
    out["bias"] = Json::array();
    for (const AllanPoint& p : curve.points) out["bias"].push_back(p.bias);
  }
  if (model != nullptr && !curve.points.empty()) add_model(out, *model);
  out["dt_s"] = curve.dt_s;
  out["samples"] = curve.samples;
  out["missing"] = curve.missing;
  out["stride_divisor"] = curve.stride_divisor;
  out["notes"] = texts_json(curve.notes);
  return out;
}

Json spectrum_channel_json(const Channel& channel,
                           const Spectrum& spectrum,
                           const ModelCurve* model,
                           const std::vector<std::optional<Interval>>& ci95) {
  Json out = named(channel);
  for (const char* key : {"frequency_hz", "value", "dof", "ci95"}) out[key] = Json::array();
  for (std::size_t i = 0; i < spectrum.frequency_hz.size(); ++i) {
    out["frequency_hz"].push_back(spectrum.frequency_hz[i]);
    out["value"].push_back(json_number(spectrum.value[i]));
    out["dof"].push_back(json_number(i < spectrum.dof.size() ? spectrum.dof[i] : 0));
    out["ci95"].push_back(ci95[i] ? interval_json(*ci95[i]) : Json(nullptr));
  }
  if (model != nullptr && !spectrum.frequency_hz.empty()) add_model(out, *model);
  out["value_unit"] = json_text(spectrum_unit(spectrum.scaling, channel.unit));
  out["window"] = name_of(spectrum.window);
  out["rate_hz"] = spectrum.rate_hz;
  out["segment"] = spectrum.segment;
  out["segments"] = spectrum.segments;
  out["dropped"] = spectrum.dropped;
  out["enbw_hz"] = json_number(spectrum.enbw_hz);
  out["notes"] = texts_json(spectrum.notes);
  return out;
}

}  // namespace libchar

#include "libchar/model/model_json.hpp"

#include <cmath>

#include "libchar/core/document.hpp"
#include "libchar/core/schema.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/core/version.hpp"
#include "libchar/model/model_reader.hpp"

namespace libchar {
namespace {

constexpr const char* kListFormat = "sensor-models";

Json term_json(const Coefficient& c, std::size_t t, const std::string& unit) {
  Json out;
  out["value"] = nullptr;
  if (c.value) out["value"] = *c.value;
  out["unit"] = term_unit(kTermNames[t].key, unit);
  if (c.value && c.status != Status::given && std::isfinite(c.ci95.low) &&
      std::isfinite(c.ci95.high)) {
    out["ci95"] = {c.ci95.low, c.ci95.high};
    out["ci95_by"] = c.profile ? "profile" : "covariance";
  }
  if (!c.value && c.upper95) out["upper95"] = *c.upper95;
  out["status"] = std::string(name_of(c.status));
  return out;
}

void put(Json& out, const char* key, const std::optional<double>& value) {
  if (value) out[key] = *value;
}

void deterministic_blocks(Json& out, const SensorModel& m) {
  if (m.scale_factor != ScaleFactor{})
    out["scale_factor"] = {{"value", m.scale_factor.value},
                           {"spread", m.scale_factor.spread},
                           {"tc1_per_k", m.scale_factor.tc1_per_k},
                           {"tc2_per_k2", m.scale_factor.tc2_per_k2}};
  if (m.nonlinearity != Nonlinearity{})
    out["nonlinearity"] = {{"quadratic", m.nonlinearity.quadratic},
                           {"quadratic_tc_per_k", m.nonlinearity.quadratic_tc_per_k},
                           {"cubic", m.nonlinearity.cubic},
                           {"cubic_tc_per_k", m.nonlinearity.cubic_tc_per_k}};
  if (m.bias != Bias{})
    out["bias"] = {{"value", m.bias.value},
                   {"spread", m.bias.spread},
                   {"tc1_per_k", m.bias.tc1_per_k},
                   {"tc2_per_k2", m.bias.tc2_per_k2}};
  if (m.reference_temperature_degc != 25)
    out["reference_temperature_degc"] = m.reference_temperature_degc;
}

void noise_blocks(Json& out, const SensorModel& m) {
  for (std::size_t t = 0; t < kTerms; ++t)
    out[std::string(kTermNames[t].key)] = term_json(m.noise[t], t, m.unit.empty() ? "U" : m.unit);
  out["noise_sampling"] =
      m.noise_sampling == NoiseSampling::band_limited ? "band-limited" : "per-sample";
  if (m.noise_start == NoiseStart::zero) out["noise_start"] = "zero";
  if (m.flicker_method != "recursive") out["flicker_method"] = m.flicker_method;
  put(out, "white_hold_s", m.white_hold_s);
  put(out, "flicker_hold_s", m.flicker_hold_s);
}

void output_blocks(Json& out, const SensorModel& m) {
  put(out, "bandwidth_hz", m.bandwidth_hz);
  if (m.saturation_low && m.saturation_high)
    out["saturation"] = {*m.saturation_low, *m.saturation_high};
  if (m.sensitivity != Sensitivity{}) {
    out["sensitivity"]["gain"] = m.sensitivity.gain;
    if (!m.sensitivity.unit.empty()) out["sensitivity"]["unit"] = m.sensitivity.unit;
  }
  put(out, "resolution", m.resolution);
  out["mean"] = m.mean;
}

void provenance(Json& out, const SensorModel& m) {
  out["obtained"] = m.obtained;
  out["method"] = m.method;
  out["recording"] = {
      {"file", m.recording_file}, {"sha256", m.recording_sha256}, {"duration_s", m.duration_s}};
  if (m.tau_max_s > 0) out["valid_tau_s"] = {m.tau_min_s, m.tau_max_s};
  if (!m.remarks.empty()) out["remarks"] = m.remarks;
}

}  // namespace

Json model_json(const SensorModel& m) {
  Json out;
  out["format"] = "sensor-model";
  out["version"] = 1;
  out["tool"] = {{"name", "sensorchar"}, {"version", std::string(version())}};
  out["channel"] = m.channel;
  if (!m.unit.empty()) out["unit"] = m.unit;
  if (!m.kind.empty()) out["kind"] = m.kind;
  if (!m.axis.empty()) out["axis"] = m.axis;
  out["rate_hz"] = m.rate_hz;
  out["sampling"] = "point";
  out["density"] = "two-sided";
  noise_blocks(out, m);
  deterministic_blocks(out, m);
  output_blocks(out, m);
  provenance(out, m);
  return out;
}

Json models_json(const std::vector<const SensorModel*>& models) {
  if (models.size() == 1) return model_json(*models.front());
  Json out;
  out["format"] = kListFormat;
  out["version"] = 1;
  out["tool"] = {{"name", "sensorchar"}, {"version", std::string(version())}};
  out["models"] = Json::array();
  for (const SensorModel* m : models) out["models"].push_back(model_json(*m));
  return out;
}

std::vector<SensorModel> read_model_list(const std::string& path) {
  const std::string text = read_document_text(path);
  const Document document =
      path.ends_with(".json") ? parse_json_document(text, path) : parse_yaml_document(text, path);
  const DocumentEntry* format =
      document.kind == Document::Kind::map ? document.find("format") : nullptr;
  if (format == nullptr || format->value.text != kListFormat) {
    check_format(document, path, "sensor-model", 1);
    return {sensor_model_of(document, path, "")};
  }
  check_format(document, path, kListFormat, 1);
  const MapReader top(document, path, "", {"format", "version", "tool", "models"});
  std::vector<SensorModel> models;
  std::size_t index = 0;
  for (const Document& node : top.list("models"))
    models.push_back(sensor_model_of(node, path, "models[" + std::to_string(index++) + "]"));
  if (models.empty()) top.refuse("models", "an empty list");
  return models;
}

}  // namespace libchar

// The JSON pieces that the verbs share; the keys are those of docs/json.md, which may grow and
// never change.

#include <algorithm>
#include <cmath>

#include "libchar/characterize/model_curve.hpp"
#include "libchar/core/units.hpp"
#include "libchar/core/version.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/json_pieces.hpp"
#include "libchar/report/outputs.hpp"

namespace libchar {
namespace {

Json interval(const Interval& i) {
  return Json::array({json_number(i.low), json_number(i.high)});
}

Json strings(const std::vector<std::string>& texts) {
  Json out = Json::array();
  for (const std::string& text : texts) out.push_back(json_text(text));
  return out;
}

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

Json frame(std::string_view format) {
  return {{"format", format}, {"version", 1}};
}

}  // namespace

Json allan_channel_json(const Channel& channel, const AllanCurve& curve, const NoiseFit* fit) {
  Json out = named(channel);
  for (const char* key : {"tau_s", "deviation", "ci95", "edf", "terms", "m", "ci68", "reliable"})
    out[key] = Json::array();
  Json model = Json::array();
  for (const AllanPoint& p : curve.points) {
    const bool known = p.edf > 0;
    out["tau_s"].push_back(p.tau_s);
    out["deviation"].push_back(json_number(p.deviation));
    out["ci95"].push_back(known ? interval(p.ci95) : Json(nullptr));
    out["edf"].push_back(known ? json_number(p.edf) : Json(nullptr));
    out["terms"].push_back(p.terms);
    out["m"].push_back(p.m);
    out["ci68"].push_back(known ? interval(p.ci68) : Json(nullptr));
    out["reliable"].push_back(p.reliable);
    if (fit != nullptr)
      model.push_back(
          json_number(model_deviation(*fit, curve.type, static_cast<double>(p.m), curve.dt_s)));
  }
  if (fit != nullptr && !curve.points.empty()) {
    out["model"] = model;
    out["asymptotes"] = asymptotes_json(allan_asymptotes(*fit, curve));
  }
  out["dt_s"] = curve.dt_s;
  out["samples"] = curve.samples;
  out["missing"] = curve.missing;
  out["stride_divisor"] = curve.stride_divisor;
  out["notes"] = strings(curve.notes);
  return out;
}

Json allan_json(const std::vector<Channel>& channels, const std::vector<AllanCurve>& curves) {
  Json out = frame("allan");
  out["type"] = name_of(curves.empty() ? DeviationType::oadev : curves[0].type);
  out["channels"] = Json::array();
  for (std::size_t i = 0; i < std::min(channels.size(), curves.size()); ++i) {
    out["channels"].push_back(allan_channel_json(channels[i], curves[i], nullptr));
  }
  return out;
}

Json spectrum_channel_json(const Channel& channel, const Spectrum& spectrum, const NoiseFit* fit) {
  IntervalFactors in95(0.95);
  return spectrum_channel_json(channel, spectrum, fit, in95);
}

Json spectrum_channel_json(const Channel& channel,
                           const Spectrum& spectrum,
                           const NoiseFit* fit,
                           IntervalFactors& in95) {
  Json out = named(channel);
  for (const char* key : {"frequency_hz", "value", "dof", "ci95"}) out[key] = Json::array();
  Json model = Json::array();
  for (std::size_t i = 0; i < spectrum.frequency_hz.size(); ++i) {
    const double dof = i < spectrum.dof.size() ? spectrum.dof[i] : 0;
    out["frequency_hz"].push_back(spectrum.frequency_hz[i]);
    out["value"].push_back(json_number(spectrum.value[i]));
    out["dof"].push_back(json_number(dof));
    if (dof > 0) {
      const auto [low, high] = in95.interval(spectrum, i);
      out["ci95"].push_back(interval({low, high}));
    } else {
      out["ci95"].push_back(nullptr);
    }
    if (fit != nullptr)
      model.push_back(json_number(model_spectrum(*fit, spectrum, spectrum.frequency_hz[i])));
  }
  if (fit != nullptr && !spectrum.frequency_hz.empty()) {
    out["model"] = model;
    out["asymptotes"] = asymptotes_json(spectrum_asymptotes(*fit, spectrum));
  }
  out["value_unit"] = json_text(spectrum_unit(spectrum.scaling, channel.unit));
  out["window"] = name_of(spectrum.window);
  out["rate_hz"] = spectrum.rate_hz;
  out["segment"] = spectrum.segment;
  out["segments"] = spectrum.segments;
  out["dropped"] = spectrum.dropped;
  out["enbw_hz"] = json_number(spectrum.enbw_hz);
  out["notes"] = strings(spectrum.notes);
  return out;
}

Json quality_channel_json(const Channel& channel, const ChannelQuality& q) {
  Json out = named(channel);
  out["missing"] = q.missing;
  out["samples"] = q.samples;
  out["mean"] = json_number(q.mean);
  out["standard_deviation"] = json_number(q.standard_deviation);
  out["minimum"] = q.samples > 0 ? json_number(q.minimum) : Json(nullptr);
  out["maximum"] = q.samples > 0 ? json_number(q.maximum) : Json(nullptr);
  out["resolution"] = json_number(q.resolution);
  out["distinct_values"] = q.distinct_values;
  out["saturated"] = q.saturated;
  out["longest_stuck"] = q.longest_stuck;
  out["difference_kurtosis"] =
      q.minimum < q.maximum ? json_number(q.difference_kurtosis) : Json(nullptr);
  out["float32"] = q.float32;
  out["float32_step"] = json_number(q.float32_step);
  out["suggestions"] = strings(q.suggestions);
  return out;
}

Json recording_json(const LogInfo& log, const std::vector<ChannelQuality>& qualities) {
  Json out = {{"file", json_text(log.file)},
              {"sha256", log.sha256},
              {"rows", log.rows},
              {"channels", Json::array()}};
  for (std::size_t i = 0; i < std::min(log.channels.size(), qualities.size()); ++i) {
    out["channels"].push_back(quality_channel_json(log.channels[i], qualities[i]));
  }
  out["rate_hz"] = log.time.rate_hz > 0 ? json_number(log.time.rate_hz) : Json(nullptr);
  out["jitter_s"] = json_number(log.time.jitter_s);
  out["gaps"] = log.time.gaps;
  out["repairs"] = Json::object();
  for (const Warning& w : log.warnings.list()) out["repairs"][w.code] = w.count;
  out["format"] = log.format;
  out["bytes"] = log.bytes;
  out["samples"] = log.samples;
  out["missing_samples"] = log.time.missing_samples;
  out["max_deviation_s"] = json_number(log.time.max_deviation_s);
  out["rate_from_stamps"] = log.time.from_stamps;
  out["time_column"] = json_text(log.time.column);
  out["time_unit"] = json_text(log.time.unit);
  out["time_unit_guessed"] = log.time.unit_guessed;
  out["start_ns"] = log.time.start_ns ? Json(*log.time.start_ns) : Json(nullptr);
  out["dialect"] = strings(log.dialect);
  out["guesses"] = strings(log.guesses);
  return out;
}

void add_provenance(Json& document,
                    const std::vector<std::string>& command,
                    const std::vector<LogInfo>& logs) {
  document["tool"] = {{"name", "sensorchar"}, {"version", version()}};
  document["command"] = strings(command);
  document["input"] = Json::array();
  document["warnings"] = Json::array();
  for (const LogInfo& log : logs) {
    document["input"].push_back(
        {{"path", json_text(log.file)}, {"sha256", log.sha256}, {"bytes", log.bytes}});
    for (const Warning& w : log.warnings.list()) {
      document["warnings"].push_back({{"code", w.code},
                                      {"message", json_text(w.message)},
                                      {"count", w.count},
                                      {"where", strings(w.places)}});
    }
  }
}

}  // namespace libchar
